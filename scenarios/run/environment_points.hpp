#pragma once

#include <vector>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/shell_cache.hpp"

namespace hapbench {

/// The point shell of an environment and how it was come by.
struct EnvironmentPoints : ShellPoints {
  bool from_cache = false;
};

/// The point shell of the scenario's environment, in the order in which `hapbench shell` writes it; empty for springs.
/// Environments that take longer to build than to read are looked up in the cache and kept there, bit for bit the same.
/// Throws InputError when a named file cannot be used.
EnvironmentPoints environment_points(const Scenario& scenario, const ShellCache& cache, const NamedFiles& files);
/// The same, reading the scenario's files.
EnvironmentPoints environment_points(const Scenario& scenario, const ShellCache& cache);

/// What determines the points: the environment with every default filled in and the contents of named files in place of
/// their paths, and the machine code that builds it. Empty when the code cannot be identified.
std::string shell_definition(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
