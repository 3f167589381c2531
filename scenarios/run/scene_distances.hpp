#pragma once

#include <cstddef>
#include <optional>

#include "scenarios/scene/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

/// Distances in a scene: between the tool and the surface, and between the points of the surface.
namespace hapbench {

/// Distance between a tool and the points of a surface.
struct Gap {
  /// Distance of the tool from the nearest point [m]. If points lie inside the tool, the depth of the deepest point
  /// with a negative sign.
  double distance = 0.0;
  std::size_t touching = 0;  ///< number of points inside or on the tool
  /// True if the nearest point can be outside of the box of a mesh tool, where ToolShape::surface_constraints() gives a
  /// lower bound of the distance for a convex tool, and an upper bound for a concave tool.
  bool is_estimate = false;
};

/// Returns the distance between the tool and the nearest point of the shell, and the number of points that touch the
/// tool. Precondition: the shell has points. O(points).
Gap gap_between(const ToolShape& tool, const ToolPose& pose, const PointShell& shell);

/// Spacing of the environment's points, and the scenario field that sets the spacing.
struct PointDistance {
  const char* path;  ///< path of the field, as in --set
  double metres;
  /// True if the scenario gives the spacing. If false, `metres` is an estimate of the mean distance between
  /// neighbouring vertices of the mesh.
  bool is_given = true;
};

/// Returns the point spacing of the environment; empty if the environment has no field that sets a spacing.
std::optional<PointDistance> point_distance(const LoadedScenario& loaded);

/// Returns the length of a box's diagonal [m].
inline double diagonal(const Box& box) {
  return box.size().norm();
}

}  // namespace hapbench
