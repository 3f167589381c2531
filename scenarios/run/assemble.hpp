#pragma once

#include <vector>

#include "scenarios/config/load_scenario.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Reads the files the scenario names, to find what is wrong with them before anything is written. Throws InputError.
void check_named_files(const LoadedScenario& loaded);

/// Numbers of the run. Precondition: defaults are filled in.
SimulationConfig simulation_config(const Scenario& scenario);

/// Everything the run is made of. Precondition: defaults are filled in. Throws InputError when a named file cannot be
/// used.
SimulationParts assemble(const Scenario& scenario);

/// The same from the points of its environment (environment_points.hpp).
SimulationParts assemble(const Scenario& scenario, const std::vector<SurfacePoint>& points);

}  // namespace hapbench
