#include "scenarios/program/new/drag_start.hpp"

#include <algorithm>

#include "scenarios/run/scene_checks.hpp"

namespace hapbench {

SurfacePoint top_center(const std::vector<SurfacePoint>& points, double top, double tolerance) {
  std::vector<SurfacePoint> high;
  for (const SurfacePoint& point : points)
    if (point.position.z() >= top - tolerance) high.push_back(point);
  Vec3 middle = Vec3::Zero();
  for (const SurfacePoint& point : high) middle += point.position;
  middle /= static_cast<double>(high.size());
  const auto distance = [&middle](const SurfacePoint& point) { return (point.position - middle).norm(); };
  return *std::ranges::min_element(high, {}, distance);
}

SurfacePoint highest_at_center(const std::vector<SurfacePoint>& points, const Box& box, double max_offset) {
  const Vec3 middle = 0.5 * (box.min + box.max);
  SurfacePoint top{{middle.x(), middle.y(), box.min.z()}};
  for (const SurfacePoint& point : points)
    if ((point.position - middle).head<2>().norm() <= max_offset && point.position.z() > top.position.z()) top = point;
  return top.position.z() > box.min.z() ? top : SurfacePoint{middle};
}

DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double min_length,
                      const std::function<double(const SurfacePath&)>& unobstructed) {
  // A later path replaces the best path only if it is longer than the best path by this factor.
  constexpr double kMinImprovement = 1.1;
  const double furthest = diagonal(shell.bounds());
  DragStart best{positions.front(), Vec3::UnitX(), smoothing, 0.0};
  for (const double radius : {smoothing, 2.0 * smoothing, 4.0 * smoothing}) {
    const SmoothedSurface surface(shell, radius);
    for (const Vec3& position : positions) {
      for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)}) {
        const SurfacePath path = SurfacePath::along(surface, position, direction, furthest);
        const double free_length = unobstructed(path);
        if (free_length > kMinImprovement * best.free_length)
          best = {position, direction, radius, free_length, free_length < path.length()};
      }
      if (best.free_length >= min_length) return best;
    }
  }
  return best;
}

}  // namespace hapbench
