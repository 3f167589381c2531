#pragma once

#include "scenarios/description/load_scenario.hpp"

namespace hapbench {

/// The point shell of the scenario's environment, in the order in which `hapbench shell` writes it; empty for springs.
/// Throws InputError when a named file cannot be used.
ShellPoints environment_points(const Scenario& scenario, const NamedFiles& files);
/// The same, reading the scenario's files.
ShellPoints environment_points(const Scenario& scenario);

}  // namespace hapbench
