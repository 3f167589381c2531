#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// The expectations of the scenario that the run does not meet, one sentence each.
std::vector<std::string> unmet_expectations(const ExpectFields& expect, const Result& run);

/// True when `outcome` is among those the scenario expects.
inline bool outcome_is_expected(const ExpectFields& expect, Outcome outcome) {
  return std::ranges::find(expect.outcomes, outcome) != expect.outcomes.end();
}

}  // namespace hapbench
