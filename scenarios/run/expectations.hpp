#pragma once

#include <algorithm>
#include <map>
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

/// A bound that a metric of a run does not keep.
struct ViolatedBound {
  enum class End { no_value, minimum, maximum };
  std::string metric;
  End end;  ///< which end of the bound; `no_value` if the metric has no value

  bool operator==(const ViolatedBound&) const = default;
};

/// Returns the bounds that the run's metrics do not keep.
std::vector<ViolatedBound> violated_bounds(const std::map<std::string, MetricBound>& bounds, const Result& run);

/// Returns true if the scenario expects `outcome`.
inline bool outcome_is_expected(const ExpectFields& expect, Outcome outcome) {
  return std::ranges::find(expect.outcomes, outcome) != expect.outcomes.end();
}

}  // namespace hapbench
