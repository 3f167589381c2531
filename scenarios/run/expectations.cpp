#include "scenarios/run/expectations.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
bool is_fault(const Divergence& divergence) {
  const bool is_force = divergence.quantity == std::string_view("rendered force");
  return !divergence.fault.empty() || (is_force && !std::isfinite(divergence.magnitude));
}

std::string divergence_text(const Result& run) {
  if (run.end.outcome != Outcome::diverges) return "";
  const Divergence& d = run.end.divergence;
  if (!d.fault.empty()) return fmt::format("{}, at step {}", d.fault, d.step);
  if (is_fault(d)) return fmt::format("{} gives a force that is not finite, at step {}", run.algorithm, d.step);
  return fmt::format("{} reached {:.4g} at step {}, beyond {:.4g}", d.quantity, d.magnitude, d.step, d.bound);
}

std::vector<ViolatedBound> violated_bounds(const std::map<std::string, MetricBound>& bounds, const Result& run) {
  using enum ViolatedBound::End;
  std::vector<ViolatedBound> violated;
  for (const auto& [name, bound] : bounds) {
    const auto number = number_of(run.metrics, name);
    if (!number) violated.push_back({name, no_value});
    if (number && bound.min && *number < *bound.min) violated.push_back({name, minimum});
    if (number && bound.max && *number > *bound.max) violated.push_back({name, maximum});
  }
  return violated;
}

std::vector<std::string> unmet_expectations(const ExpectFields& expect, const Result& run) {
  std::vector<std::string> unmet;
  // Check the outcome.
  if (!outcome_is_expected(expect, run.end.outcome)) {
    const std::string divergence = divergence_text(run);
    unmet.push_back(fmt::format("outcome is \"{}\"{}; expected {}", outcome_name(run.end.outcome),
                                divergence.empty() ? "" : " (" + divergence + ")",
                                quoted_list(names_of(expect.outcomes, outcome_name))));
  }
  // Check the bounds of each metric.
  for (const auto& [name, end] : violated_bounds(expect.metrics, run)) {
    if (end == ViolatedBound::End::no_value) {
      unmet.push_back(fmt::format("{} has no value; the scenario expects one", name));
      continue;
    }
    const MetricBound& bound = expect.metrics.at(name);
    const bool is_min = end == ViolatedBound::End::minimum;
    unmet.push_back(fmt::format("{} is {}; expected at {} {}", name, *number_of(run.metrics, name),
                                is_min ? "least" : "most", is_min ? *bound.min : *bound.max));
  }
  return unmet;
}

}  // namespace hapbench
