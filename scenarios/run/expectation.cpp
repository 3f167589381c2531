#include "scenarios/run/expectation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

std::string divergence_text(const SimulationResult& result) {
  if (result.outcome != Outcome::diverges) return "";
  const Divergence& d = result.divergence;
  if (!d.fault.empty()) return fmt::format(" ({}, at step {})", d.fault, d.step);
  return fmt::format(" ({} reached {:.4g} at step {}, beyond {:.4g})", d.quantity, d.magnitude, d.step, d.bound);
}

std::vector<std::string> names_of(const std::vector<Outcome>& outcomes) {
  std::vector<std::string> names;
  for (const Outcome outcome : outcomes) names.emplace_back(outcome_name(outcome));
  return names;
}

}  // namespace

bool outcome_is_expected(const ExpectFields& expect, Outcome outcome) {
  return std::find(expect.outcomes.begin(), expect.outcomes.end(), outcome) != expect.outcomes.end();
}

std::vector<std::string> unmet_expectations(const ExpectFields& expect, const RunSummary& run) {
  std::vector<std::string> unmet;
  if (!outcome_is_expected(expect, run.result.outcome)) {
    unmet.push_back(fmt::format("outcome is \"{}\"{}; expected {}", outcome_name(run.result.outcome),
                                divergence_text(run.result), quoted_list(names_of(expect.outcomes))));
  }
  const MetricList metrics = metric_list(run);
  for (const auto& [name, bound] : expect.metrics) {
    const auto number = number_of(value_of(metrics, name));
    if (!number) {
      unmet.push_back(fmt::format("{} has no value; expected one", name));
      continue;
    }
    if (bound.min && *number < *bound.min)
      unmet.push_back(fmt::format("{} is {}; expected at least {}", name, *number, *bound.min));
    if (bound.max && *number > *bound.max)
      unmet.push_back(fmt::format("{} is {}; expected at most {}", name, *number, *bound.max));
  }
  return unmet;
}

}  // namespace hapbench
