#pragma once

#include <cstddef>

#include "scenarios/batch/axis.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// Repetitions of a scenario with other seeds and other starts.
namespace hapbench {

/// The scenario's seed and those after it. Unless `jitter` [m] is 0, a shift of the start by that length goes along
/// with each, whose direction depends only on the seed, so that all algorithms start from the same places: uniform on
/// the sphere, in planar scenes on the circle z = 0.
Axis seed_axis(const Scenario& scenario, std::size_t seeds, double jitter);

}  // namespace hapbench
