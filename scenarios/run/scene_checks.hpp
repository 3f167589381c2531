#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "scenarios/run/scene_distances.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Facts about a scenario that are known before it runs.
struct SceneFacts {
  /// The points of the environment; springs have none.
  struct Surface {
    Box box;
    std::size_t points = 0;
    Gap start;  ///< where the tool starts
  };
  std::optional<Surface> surface;
  std::shared_ptr<const ToolShape> tool;
  std::optional<bool> is_closed;  ///< of a mesh
  std::vector<Warning> warnings;  ///< about the tool, and the way of its drag, in this scene
};

/// Builds the environment and places the tool. Throws InputError when a named file cannot be used.
SceneFacts scene_facts(const LoadedScenario& loaded);

}  // namespace hapbench
