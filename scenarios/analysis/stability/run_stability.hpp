#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "scenarios/analysis/stability/run_end_observer.hpp"
#include "scenarios/analysis/stability/run_verdict.hpp"
#include "scenarios/analysis/stability/stability_rule.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/expectations.hpp"
#include "sim/geometry/point_shell.hpp"

/// Decides whether a run is stable, by its motion (motion_classifier.hpp) and by the outcome of the run.
namespace hapbench {

/// The verdict on one run. A run with several trials is stable if all its trials are stable; its verdict is the verdict
/// on the first trial that the rule (StabilityRule::holds) does not count as stable.
struct RunStability {
  RunVerdict verdict = RunVerdict::stable;
  /// State of the trial that the rule does not count as stable, or of the first trial. In the second case, `vibration`,
  /// `touch_speed` and `hand_force_max` are the largest over all trials.
  SettledState settled;
  std::uint64_t motion_hash = 0;  ///< hash of all positions of the handle; equal for bitwise equal motions
  /// True if even the longest run was too short to judge: the tool still moves but does not oscillate.
  bool undecided = false;
  /// True if the run vibrates, but its amplitude falls from each quarter of the run to the next
  /// (MotionClassifier::fades).
  bool fades = false;
  /// The bounds that the run does not keep; empty unless the verdict is `beyond_bound`.
  std::vector<ViolatedBound> violated = {};
};

/// Runs the trials of the scenario without records, up to the first trial that is not stable, and returns the verdict.
/// If a trial is too short to judge, makes up to three further runs of it, each four times as long as the run before
/// and of at most 10^6 steps. If the rule has bounds on metrics and the run is stable, runs the scenario again to
/// compute the metrics. `shell`: make_shell() of the scenario. Throws Stopped. Precondition: the position of the tool
/// is free, and the scenario has at least 4 steps.
RunStability stability_of(const CheckedScenario& checked, std::shared_ptr<const PointShell> shell,
                          const StabilityRule& rule = {});

/// Returns true if the tool vibrates or diverges without any environment: then hand and device, not the contact, are
/// the cause of the instability. Returns false for hands whose force does not depend on the handle, and for an
/// environment of springs. `max_vibration`: see StabilityRule.
bool unstable_without_contact(const CheckedScenario& checked, std::optional<double> max_vibration = {});

}  // namespace hapbench
