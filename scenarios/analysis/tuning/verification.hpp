#pragma once

#include <string>

#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// Verifies a choice before it is recommended: at stiffnesses slightly below K, at gains that lie between the evaluated
/// gains, in longer runs, and against the stability limit of the scene.
namespace hapbench {

/// Returns the override that sets the stiffness to the trial's K times `gain`.
std::string with_gain(const TuneTrial& trial, double gain);

/// Returns true if a choice passes all verifications, the cheapest first:
/// - the diagnosis of the scene's run, as the command `run` makes it, reports no failure and, unless
///   TuneLimits::allow_vibration is true, no vibration (RuleKind);
/// - from kLowVibrationFrom x K to K, the run of the scene does not vibrate: neither in the known trials of the setting
///   nor at kLowVibrationSamples further stiffnesses (Trials::vibrations()). This check is skipped if
///   TuneLimits::allow_vibration is true;
/// - it is settled at 56 gains from 1 to G, in runs that cycle through the variants;
/// - the stability limit of K in the scene itself, found by field_limit(), is beyond G K;
/// - it is settled in runs twice as long. This check is skipped if a script would move the tool on after the scene's
///   end.
///
/// If a verification fails, refutes the choice in `trials` (Trials::refute). Writes TunedLaw::findings, verified and
/// limits.
bool is_verified(Trials& trials, const TuneTrial& choice, TunedLaw& law);

}  // namespace hapbench
