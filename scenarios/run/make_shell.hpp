#pragma once

#include <memory>

#include "scenarios/description/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// The point shell of the scenario's environment, in the order in which `hapbench shell` writes it; null for springs.
/// Throws InputError when a named file cannot be used.
std::shared_ptr<const PointShell> make_shell(const Scenario& scenario, const NamedFiles& files);
/// The same, reading the scenario's files.
std::shared_ptr<const PointShell> make_shell(const Scenario& scenario);

}  // namespace hapbench
