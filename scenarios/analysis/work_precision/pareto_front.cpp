#include "scenarios/analysis/work_precision/pareto_front.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "sim/core/math.hpp"

namespace hapbench {

std::vector<std::size_t> pareto_front(std::span<const CostAndError> points) {
  std::vector<std::size_t> order(points.size()), front;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [points](std::size_t a, std::size_t b) {
    return points[a].cost != points[b].cost ? points[a].cost < points[b].cost : points[a].error < points[b].error;
  });
  double smallest = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (points[i].error >= smallest) continue;
    smallest = points[i].error;
    front.push_back(i);
  }
  return front;
}

std::optional<std::size_t> knee(std::span<const CostAndError> points, std::span<const std::size_t> front) {
  constexpr std::size_t kMinPoints = 4;
  if (front.size() < kMinPoints) return std::nullopt;
  const CostAndError &cheap = points[front.front()], &exact = points[front.back()];
  const double costs = math::log(exact.cost / cheap.cost), errors = math::log(cheap.error / exact.error);
  if (!std::isfinite(costs) || !std::isfinite(errors) || costs <= 0.0 || errors <= 0.0) return std::nullopt;
  std::optional<std::size_t> best;
  double farthest = kMinKnee;
  for (const std::size_t i : front.subspan(1, front.size() - 2)) {
    // In the scaled logarithms the chord runs from (0, 1) to (1, 0).
    const double x = math::log(points[i].cost / cheap.cost) / costs;
    const double y = math::log(points[i].error / exact.error) / errors;
    const double below = (1.0 - x - y) / std::numbers::sqrt2;
    if (below > farthest) {
      farthest = below;
      best = i;
    }
  }
  return best;
}

}  // namespace hapbench
