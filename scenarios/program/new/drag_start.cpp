#include "scenarios/program/new/drag_start.hpp"

#include <algorithm>

#include "device_model/hands/drag_hand.hpp"
#include "scenarios/run/scene_checks.hpp"

namespace hapbench {

Vec3 top_center(const std::vector<SurfacePoint>& points, double top, double tolerance) {
  std::vector<Vec3> high;
  for (const SurfacePoint& point : points)
    if (point.position.z() >= top - tolerance) high.push_back(point.position);
  Vec3 middle = Vec3::Zero();
  for (const Vec3& position : high) middle += position;
  middle /= static_cast<double>(high.size());
  return *std::ranges::min_element(high, {}, [&middle](const Vec3& position) { return (position - middle).norm(); });
}

Vec3 highest_at_center(const std::vector<SurfacePoint>& points, const Box& box, double max_offset) {
  const Vec3 middle = 0.5 * (box.min + box.max);
  Vec3 top(middle.x(), middle.y(), box.min.z());
  for (const SurfacePoint& point : points)
    if ((point.position - middle).head<2>().norm() <= max_offset && point.position.z() > top.z()) top = point.position;
  return top.z() > box.min.z() ? top : middle;
}

DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double min_length) {
  // A later path replaces the best path only if it is longer than the best path by this factor.
  constexpr double kMinImprovement = 1.1;
  const double furthest = diagonal(shell.bounds());
  DragStart best{positions.front(), Vec3::UnitX(), smoothing, 0.0};
  for (const double radius : {smoothing, 2.0 * smoothing, 4.0 * smoothing}) {
    const SmoothedSurface surface(shell, radius);
    for (const Vec3& position : positions) {
      for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)}) {
        const double free_length = SurfacePath::along(surface, position, direction, furthest).length();
        if (free_length > kMinImprovement * best.free_length) best = {position, direction, radius, free_length};
      }
      if (best.free_length >= min_length) return best;
    }
  }
  return best;
}

}  // namespace hapbench
