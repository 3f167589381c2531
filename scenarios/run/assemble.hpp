#pragma once

#include <vector>

#include "scenarios/config/load_scenario.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// The point shell of the scenario's environment, in the order in which `hapbench shell` writes it; empty for springs.
/// Throws InputError when a named file cannot be used.
std::vector<SurfacePoint> environment_points(const Scenario& scenario);

/// Reads the files the scenario names, to find what is wrong with them before anything is written. Returns warnings
/// about what is odd, each with file and pointer. Throws InputError.
std::vector<std::string> check_named_files(const LoadedScenario& loaded);

/// Numbers of the run. Precondition: defaults are filled in.
SimulationConfig simulation_config(const Scenario& scenario);

/// Everything the run is made of. Precondition: defaults are filled in. Throws InputError when a named file cannot be
/// used.
SimulationParts assemble(const Scenario& scenario);

}  // namespace hapbench
