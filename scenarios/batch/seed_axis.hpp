#pragma once

#include <cstddef>

#include "scenarios/batch/axis.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// Repetitions of a scenario with other seeds and other starting positions.
namespace hapbench {

/// Returns an axis with the scenario's seed and the next `seeds` - 1 integers. If `jitter` [m] is not 0, the
/// starting position is also displaced by this length for each seed. The direction of the displacement depends
/// only on the seed, so that all algorithms start from the same positions. It is uniform on the sphere; in
/// planar scenes, it is uniform on the circle in the plane z = 0.
Axis seed_axis(const Scenario& scenario, std::size_t seeds, double jitter);

}  // namespace hapbench
