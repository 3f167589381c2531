#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "scenarios/run/scene_distances.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Properties of a scenario's scene that are known before the run.
struct SceneFacts {
  /// Bounding box and number of the points of the environment's point shell. An environment of springs has no points.
  struct Surface {
    Box box;
    std::size_t points = 0;
    Gap start;  ///< distance between tool and surface at the start
  };
  std::optional<Surface> surface;
  std::shared_ptr<const ToolShape> tool;
  std::optional<bool> is_closed;  ///< for a mesh: MeshFile::knows_outside(); empty for other environments
  std::vector<Warning> warnings;  ///< warnings about sizes, time step, tool, starting position and path of a drag
};

/// Builds the environment, places the tool in its starting pose and checks the scene. Throws InputError if a
/// named file cannot be used.
SceneFacts scene_facts(const LoadedScenario& loaded);

}  // namespace hapbench
