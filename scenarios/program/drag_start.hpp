#pragma once

#include <span>
#include <vector>

#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// A way over a surface for a new scenario of a hand that drags.
struct DragStart {
  Vec3 position = Vec3::Zero();    ///< initial.position_m [m]
  Vec3 direction = Vec3::UnitX();  ///< hand.direction
  double smoothing = 0.0;          ///< hand.smoothing_m [m]
  double room = 0.0;               ///< way to where the surface ends or turns against the direction [m]
};

/// Tries along x and y, forwards and back, from each of `positions`, then with twice and four times `smoothing`, until
/// a way is at least `enough` long; else the longest. A direction or place later in the order has to lead a tenth
/// further, so that the choice does not hang on rounding. As many walks as there are combinations, some 10 ms each.
/// Preconditions: a point in the shell, a position.
DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double enough);

}  // namespace hapbench
