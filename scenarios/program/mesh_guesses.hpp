#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/mesh/triangle_soup.hpp"

/// Guesses for a new scenario from a mesh: the tip of a tool, and where a tool that comes along -z starts over it.
namespace hapbench {

/// The guessed tip of a tool's mesh.
struct TipOfMesh {
  Vec3 place;      ///< the end of its longest direction where it is thinner [m]
  Vec3 direction;  ///< out of the tip, a unit vector
};

/// Guesses a tool's tip. A mesh without a longest direction has it at its lowest place, along -z. Precondition: it has
/// triangles.
TipOfMesh guess_tip(const TriangleSoup& mesh);

/// The point nearest to the middle of those within `tolerance` of the top.
Vec3 middle_of_the_top(const std::vector<SurfacePoint>& points, double top, double tolerance);

/// The highest of the points above or below the box's middle, to within `aside`; where there are none, as in a ring,
/// the middle.
Vec3 top_of_the_middle(const std::vector<SurfacePoint>& points, const Box& box, double aside);

/// A way over a surface for a hand that drags.
struct DragStart {
  Vec3 position = Vec3::Zero();    ///< initial.position_m [m]
  Vec3 direction = Vec3::UnitX();  ///< hand.direction
  double smoothing = 0.0;          ///< hand.smoothing_m [m]
  double room = 0.0;               ///< length of the way to where the surface ends or turns back [m]
};

/// Tries along x and y, forwards and back, from each of `positions`, then with twice and four times `smoothing`, until
/// a way is at least `enough` long; else takes the longest. A later direction or place has to lead a tenth further, so
/// that the choice does not depend on rounding. Makes a walk of some 10 ms for each combination. Preconditions: a point
/// in the shell, a position.
DragStart choose_drag(const PointShell& shell, std::span<const Vec3> positions, double smoothing, double enough);

}  // namespace hapbench
