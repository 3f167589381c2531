#pragma once

#include <memory>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/run/diagnosis_observer.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

/// Rules that report what is wrong with a run and what to try. Each rule compares a number (a metric, or a
/// quantity that DiagnosisObserver measures) with a threshold.
namespace hapbench {

/// Returns all rules with their thresholds but without values and advice, in the order of the report: first how
/// the run ended, then possible causes. `says` has {} in place of the value. With `low_vibration`, returns only the
/// rules for disturbances that a hand feels in addition to the force (vibration, force steps, force reversals, created
/// energy).
std::vector<Diagnosed> diagnosis_rules(bool low_vibration = false);

/// Returns the rules of diagnosis_rules(true) with their values for this result, including values below the
/// thresholds. A rule whose number has no value is left out. `observations`, `tool` and `shell` as for
/// diagnosis_findings(), so that both functions compare the same numbers with the thresholds.
std::vector<Diagnosed> low_vibration_numbers(const LoadedScenario& loaded, const Result& result,
                                             const RunObservations& observations, const ToolShape& tool,
                                             std::shared_ptr<const PointShell> shell = {});

/// Returns the rules whose threshold this run exceeds, in the order of diagnosis_rules(). `observations`,
/// `tool` and `shell` belong to the run that gave `result`. Cost: a few ms if the eigenvalues of a linear loop are
/// computed.
std::vector<Diagnosed> diagnosis_findings(const LoadedScenario& loaded, const Result& result,
                                          const RunObservations& observations, const ToolShape& tool,
                                          std::shared_ptr<const PointShell> shell = {});

/// Returns warnings for a run without a diagnosis, such as a run of a sweep. The warnings report simulation effects
/// that can be mistaken for effects of the force law, such as unstable explicit friction.
std::vector<Warning> rule_warnings(const LoadedScenario& loaded, const Result& result);

}  // namespace hapbench
