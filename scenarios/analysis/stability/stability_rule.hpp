#pragma once

#include <map>
#include <optional>
#include <string>

#include "scenarios/analysis/stability/run_verdict.hpp"
#include "scenarios/scene/scenario.hpp"

/// The rule that decides whether a run is stable.
namespace hapbench {

/// Conditions that a stable run satisfies.
struct StabilityRule {
  /// Largest allowed vibration of the handle above 30 Hz over the judged steps (EvaluationWindow) [m/s rms]. If set,
  /// the vibration decides instead of the class of motion: a run with at most this vibration is stable; a run with a
  /// larger vibration is not stable, even if the vibration decays. A run without a measured vibration is not stable. A
  /// run with persistent slow bounces (SlowBounces) is vibrating.
  std::optional<double> max_vibration = {};
  /// Bounds on metrics of summary.json, by name. A metric without a value violates its bound.
  std::map<std::string, MetricBound> bounds = {};
  bool bounded = false;  ///< true: a run of class `vibrating`, whose amplitude does not grow, also counts as stable
  /// False: the outcomes `stuck` and `not_dragged` are ignored, so that the motion decides about a tool that does not
  /// follow its hand.
  bool judges_progress = true;

  /// Returns true if a run with this verdict is stable by this rule.
  bool holds(RunVerdict verdict) const noexcept;
};

/// Returns the default rule of a scenario. The class of motion decides; if a script moves the tool, the vibration
/// decides (limit: kMaxVibration). At sampling rates of 60 Hz or less, the class of motion always decides.
StabilityRule rule_of(const Scenario& scenario);

}  // namespace hapbench
