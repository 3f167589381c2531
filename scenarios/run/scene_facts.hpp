#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scenarios/description/load_scenario.hpp"
#include "sim/core/box.hpp"

namespace hapbench {

/// What there is to know of a scenario before it runs.
struct SceneFacts {
  /// Of an environment of points; none for springs.
  struct Surface {
    Box box;
    std::size_t points = 0;
    /// Distance of the tool, where it starts, from the nearest point [m]; when negative, how deep the deepest point
    /// lies in it.
    double gap = 0.0;
    std::size_t touching = 0;  ///< points in the tool where it starts
  };
  std::optional<Surface> surface;
  std::optional<bool> is_closed;  ///< of a mesh
  std::size_t trials = 1;
};

/// Builds the environment and places the tool. Throws InputError when a named file cannot be used.
SceneFacts scene_facts(const LoadedScenario& loaded);

}  // namespace hapbench
