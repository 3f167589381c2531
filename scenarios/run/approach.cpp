#include "scenarios/run/approach.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenarios/run/scene_distances.hpp"

namespace hapbench {

Approach::Approach(std::shared_ptr<const PointShell> shell, std::uint64_t steps)
    : shell_(std::move(shell)), environment_(shell_->bounds()), every_(steps / kLooks + 1) {
  looks_.reserve(kLooks);
}

void Approach::add(const StepRecord& record, bool looks) noexcept {
  const Vec3& place = record.tool.pose.position;
  const double way = (place - place_).norm();
  if (distance_ <= way && std::isfinite(way)) longest_step_ = std::max(longest_step_, way);
  place_ = place;
  time_ = record.time;
  distance_ = distance_to(environment_, place);
  if (!looks) return;
  const Look look{record.time, distance_, record.tool.pose};
  if (record.step % every_ == 0) {
    looks_.push_back(look);
  } else if (look.from_box <= looks_.back().from_box) {
    looks_.back() = look;
  }
}

Approach::Closest Approach::closest_to_surface(const ToolShape& tool) const {
  constexpr double kWithin = 0.99;
  Closest closest{std::numeric_limits<double>::infinity(), 0.0};
  std::vector<double> least(looks_.size(), 0.0);
  for (;;) {
    const auto next = std::ranges::min_element(least);
    if (next == least.end() || *next >= kWithin * closest.distance) break;
    const Look& look = looks_[static_cast<std::size_t>(next - least.begin())];
    const double gap = gap_between(tool, look.pose, *shell_).distance;
    if (gap < closest.distance) closest = {gap, look.time};
    for (std::size_t i = 0; i < looks_.size(); ++i)
      least[i] = std::max(least[i], gap - tool.moved_at_most(look.pose, looks_[i].pose));
    *next = std::numeric_limits<double>::infinity();
  }
  if (closest.time != time_ || looks_.size() < 2) return closest;
  const Look& before = *(looks_.end() - 2);
  const double nearer = gap_between(tool, before.pose, *shell_).distance - closest.distance;
  if (nearer > 0.0) closest.rest = closest.distance / nearer * (time_ - before.time);
  return closest;
}

}  // namespace hapbench
