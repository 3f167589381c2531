#pragma once

#include <map>
#include <optional>
#include <string>

#include "scenarios/analysis/stability/run_verdict.hpp"
#include "scenarios/scene/scenario.hpp"

/// The rule by which a run is stable.
namespace hapbench {

/// Conditions that a run has to meet to be stable.
struct StabilityRule {
  /// Largest vibration of the handle in the judged rows [m/s rms]. With it the vibration decides instead of the motion:
  /// a motion that is too small to be felt is stable, a motion that is felt is not, although it may die out. A run
  /// without a measured vibration is not stable. A tool that bounces below 30 Hz vibrates while its bounces do not get
  /// lower by 1 %.
  std::optional<double> most_vibration = {};
  /// Bounds on metrics of summary.json; a metric without a value is out of bounds.
  std::map<std::string, MetricBound> bounds = {};
  bool bounded = false;  ///< a run that vibrates without growing is also stable

  /// Returns true if the rule calls a run with this verdict stable.
  bool holds(RunVerdict verdict) const noexcept;
};

/// Returns the default rule of a scenario: the motion decides. If a script moves the tool, the vibration decides
/// (kMostVibration), except at sampling rates of 60 Hz or less.
StabilityRule rule_of(const Scenario& scenario);

}  // namespace hapbench
