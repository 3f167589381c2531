#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/run/diagnosis_observer.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

/// Rules that report what is wrong with a run and what to try. Each rule compares a number (a metric, or a
/// quantity that DiagnosisObserver measures) with a threshold.
namespace hapbench {

/// Kind of a diagnosis rule: a failed run, a vibration, or a hint.
enum class RuleKind {
  failure,        ///< the run failed, or its loop is unstable: no such run is recommended
  low_vibration,  ///< the hand feels a disturbance in addition to the force: a vibration, force steps, force reversals,
                  ///< or created energy. A user of `tune` may allow it
  hint            ///< a property of the run that may be as intended, or the cause of another problem
};
/// Returns the name of a kind in result files: "failure", "vibration" or "hint".
const char* rule_kind_name(RuleKind kind) noexcept;

/// Returns the rules of a kind, or all rules, with their thresholds but without values and advice, in the order of the
/// report: first how the run ended, then possible causes. `says` has {} in place of the value.
std::vector<Diagnosed> diagnosis_rules(std::optional<RuleKind> kind = {});
/// Returns the names of the rules of a kind, separated by commas.
std::string rule_names(RuleKind kind);
/// Returns the kind of the rule with this name. Precondition: there is such a rule.
RuleKind rule_kind(std::string_view rule);

/// Returns the rules of RuleKind::low_vibration with their values for this result, including values below the
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
