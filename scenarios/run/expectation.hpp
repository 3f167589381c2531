#pragma once

#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// What the run does not show although the scenario expects it, one sentence each; empty when all is as expected.
std::vector<std::string> unmet_expectations(const ExpectFields& expect, const RunSummary& run);

/// True when `outcome` is among those the scenario expects.
bool outcome_is_expected(const ExpectFields& expect, Outcome outcome);

}  // namespace hapbench
