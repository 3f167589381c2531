#pragma once

#include <string>
#include <vector>

#include "scenarios/description/bundled_scenarios.hpp"

namespace hapbench::test {

/// Arguments that make a bundled scenario a matter of milliseconds, for tests that run it several times and compare:
/// its first simulated seconds, one trial, any outcome. None for scenarios that are short anyway.
std::vector<std::string> shortened(const BundledScenario& bundled);

}  // namespace hapbench::test
