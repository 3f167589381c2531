#pragma once

#include <string>
#include <vector>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"

namespace hapbench::test {

/// A scenario that comes with the program.
inline Scenario bundled(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return load_scenario(find_scenario(name), overrides).scenario;
}

}  // namespace hapbench::test
