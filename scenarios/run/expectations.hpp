#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Returns true if a diverged run ended because a law or a module failed, or gave a force that is not finite.
bool is_fault(const Divergence& divergence);

/// Returns which quantity diverged, or which law failed, and at which step; empty if the run did not diverge.
std::string divergence_text(const Result& run);

/// Returns one sentence for each expectation of the scenario that the run does not meet.
std::vector<std::string> unmet_expectations(const ExpectFields& expect, const Result& run);

/// Returns the bounds that the run's metrics do not keep, such as "inside_max_m max"; "NAME none" for a metric without
/// a value.
std::vector<std::string> violated_bounds(const std::map<std::string, MetricBound>& bounds, const Result& run);

/// Returns true if the scenario expects `outcome`.
inline bool outcome_is_expected(const ExpectFields& expect, Outcome outcome) {
  return std::ranges::find(expect.outcomes, outcome) != expect.outcomes.end();
}

}  // namespace hapbench
