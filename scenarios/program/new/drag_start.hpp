#pragma once

#include <functional>
#include <span>
#include <vector>

#include "device_model/hands/drag_hand.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"

/// Start position and direction of a tool that approaches along -z and that a hand then drags over a surface.
namespace hapbench {

/// Among the points within `tolerance` [m] of the height `top` [m], returns the point nearest to their mean.
/// Precondition: there is such a point.
SurfacePoint top_center(const std::vector<SurfacePoint>& points, double top, double tolerance);
/// Returns the highest point within the horizontal distance `max_offset` [m] of the box's vertical centre line.
/// Returns the box's centre with the normal +z if there is no such point, for example in a ring.
SurfacePoint highest_at_center(const std::vector<SurfacePoint>& points, const Box& box, double max_offset);

/// Path over a surface for a hand that drags the tool.
struct DragStart {
  Vec3 position = Vec3::Zero();    ///< initial.position_m [m]
  Vec3 direction = Vec3::UnitX();  ///< hand.direction
  double smoothing = 0.0;          ///< hand.smoothing_m [m]
  double free_length = 0.0;        ///< length of the path, which ends where the surface ends or turns back [m]
  bool is_blocked = false;         ///< true if the path ends earlier, at an obstacle
};

/// Chooses the start position and direction of a drag. Evaluates the directions +x, +y, -x and -y from each position.
/// Does so with the smoothing radius `smoothing` [m], then with twice and four times this radius, until a path is at
/// least `min_length` [m] long. If no path is that long, returns the longest path. A later path is preferred only if it
/// is 10 % longer, so that rounding does not decide. Cost: about 10 ms for each combination of position, direction and
/// smoothing radius. `unobstructed`: returns the length of a path up to its first obstacle [m]. Precondition: the shell
/// has points and `positions` is not empty.
DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double min_length,
                      const std::function<double(const SurfacePath&)>& unobstructed);

}  // namespace hapbench
