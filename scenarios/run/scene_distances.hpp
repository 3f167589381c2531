#pragma once

#include <cstddef>
#include <optional>

#include "scenarios/scene/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

/// Distances in a scene: of the tool from the surface, and of the surface's points from each other.
namespace hapbench {

/// The place of a tool against the points of a surface.
struct Gap {
  /// Distance of the tool from the nearest point [m]; when negative, how deep the deepest point lies in it.
  double distance = 0.0;
  std::size_t touching = 0;  ///< points in the tool
};

/// Looks at all points of the shell, which has some.
Gap gap_between(const ToolShape& tool, const ToolPose& pose, const PointShell& shell);

/// The field that sets the distance of the shell's points, and this distance.
struct PointDistance {
  const char* path;  ///< of the field, as in --set
  double metres;
  bool is_given = true;  ///< false: the mean distance of the vertices of a mesh that is taken as it is
};

/// Empty where no field sets it.
std::optional<PointDistance> point_distance(const LoadedScenario& loaded);

/// The length of a box from corner to corner [m].
inline double diagonal(const Box& box) {
  return box.size().norm();
}

}  // namespace hapbench
