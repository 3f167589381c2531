#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "scenarios/analysis/stability/last_rows.hpp"
#include "scenarios/analysis/stability/run_verdict.hpp"
#include "scenarios/analysis/stability/stability_rule.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "sim/geometry/point_shell.hpp"

/// Judges whether a run is stable: by its motion (motion_classifier.hpp), then by where its tool ends.
namespace hapbench {

struct RunStability {
  RunVerdict verdict = RunVerdict::stable;
  SettledState settled;
  std::uint64_t motion_hash = 0;  ///< of all positions of the handle: runs that differ in it moved differently
  /// The tool is neither at rest nor does the run last long enough for an oscillation, although it was made four times
  /// as long up to three times.
  bool undecided = false;
};

/// Runs the scenario's first trial, without records, and judges it; makes the run longer if it is too short to judge.
/// If the rule has bounds and the run is stable, runs it again for its metrics. `shell` is make_shell() of the
/// scenario. Throws Stopped. Precondition: the position is free, and there are 4 steps or more.
RunStability stability_of(const CheckedScenario& checked, std::shared_ptr<const PointShell> shell,
                          const StabilityRule& rule = {});

/// Returns true if the tool vibrates or diverges without any environment: then hand and device are the cause and not
/// the contact. `most_vibration` as in StabilityRule. Returns false for hands that do not feel the handle, and for
/// hands that need a surface.
bool unstable_without_contact(const CheckedScenario& checked, std::optional<double> most_vibration = {});

}  // namespace hapbench
