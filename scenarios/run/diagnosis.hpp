#pragma once

#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/run/diagnosis_observer.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/tool/tool_shape.hpp"

/// What is wrong with a run and what to try, by rules: a metric, or a number of an observer, above a threshold.
namespace hapbench {

/// The rules without a value and texts, in the order in which they are told: how the run ended, then why. With `quiet`
/// those that a quiet run keeps: what is felt besides the force, told by metrics alone.
std::vector<Diagnosed> diagnosis_rules(bool quiet = false);

/// What the rules of a quiet run find in this result, also below their thresholds; empty where they have no number.
std::vector<Diagnosed> quiet_numbers(const LoadedScenario& loaded, const Result& result);

/// What is wrong with the run that gave this result and these rows, in the order of the rules. Some ms where a loop is
/// solved.
std::vector<Diagnosed> diagnosis_findings(const LoadedScenario& loaded, const Result& result, const SeenRows& rows,
                                          const ToolShape& tool);

/// What is told of a run that nobody diagnoses, as one of many: that it is not the law which made its numbers.
std::vector<Warning> rule_warnings(const LoadedScenario& loaded, const Result& result);

}  // namespace hapbench
