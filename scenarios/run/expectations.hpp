#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Returns one sentence for each expectation of the scenario that the run does not meet.
std::vector<std::string> unmet_expectations(const ExpectFields& expect, const Result& run);

/// Returns true if the scenario expects `outcome`.
inline bool outcome_is_expected(const ExpectFields& expect, Outcome outcome) {
  return std::ranges::find(expect.outcomes, outcome) != expect.outcomes.end();
}

}  // namespace hapbench
