#include "scenarios/program/drag_start.hpp"

#include "device_model/hands/drag_hand.hpp"

namespace hapbench {

DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double enough) {
  constexpr double kFurther = 1.1;
  const Box box = shell.bounds();
  const double furthest = (box.max - box.min).norm();
  DragStart best{positions.front(), Vec3::UnitX(), smoothing, 0.0};
  for (const double radius : {smoothing, 2.0 * smoothing, 4.0 * smoothing}) {
    const SmoothedSurface surface(shell, radius);
    for (const Vec3& position : positions) {
      for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)}) {
        const double room = SurfacePath::along(surface, position, direction, furthest).length();
        if (room > kFurther * best.room) best = {position, direction, radius, room};
      }
      if (best.room >= enough) return best;
    }
  }
  return best;
}

}  // namespace hapbench
