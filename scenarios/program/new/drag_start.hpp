#pragma once

#include <span>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"

/// Where a tool that comes along -z starts over a surface, and where a hand drags it to.
namespace hapbench {

/// The point nearest to the middle of those within `tolerance` of the top.
Vec3 middle_of_the_top(const std::vector<SurfacePoint>& points, double top, double tolerance);
/// The highest of the points within `aside` of the box's middle line; where there are none, as in a ring, the middle.
Vec3 top_of_the_middle(const std::vector<SurfacePoint>& points, const Box& box, double aside);

/// A way over a surface for a hand that drags.
struct DragStart {
  Vec3 position = Vec3::Zero();    ///< initial.position_m [m]
  Vec3 direction = Vec3::UnitX();  ///< hand.direction
  double smoothing = 0.0;          ///< hand.smoothing_m [m]
  double room = 0.0;               ///< length of the way to where the surface ends or turns back [m]
};

/// Tries along x and y, forwards and back, from each of `positions`, then with twice and four times `smoothing`, until
/// a way is at least `enough` long; else takes the longest. A later one has to lead a tenth further, so that rounding
/// does not decide. A walk of some 10 ms for each combination. Preconditions: a point in the shell, a position.
DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double enough);

}  // namespace hapbench
