#pragma once

#include <string>

#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// Verifies a choice before it is recommended: between the evaluated gains, in longer runs, against the stability limit
/// of the scene, and within the errors of its metrics.
namespace hapbench {

/// Returns the override that sets the stiffness to the trial's K times `gain`.
std::string with_gain(const TuneTrial& trial, double gain);

/// Returns error estimates of the metrics of a trial (TunedLaw::error), by runs with half the step, with half the point
/// spacing, and with depth evaluated at every step.
TuneMetrics known_errors(Trials& trials, const TuneTrial& trial);

/// Returns true if a choice passes all verifications, the cheapest first:
/// - it is settled at 56 gains from 1 to G, in runs that cycle through the variants;
/// - the stability limit of K in the scene itself, found by field_limit(), is beyond G K;
/// - it is settled in runs twice as long; this is not checked if a script would go on after the end of the scene;
/// - it keeps the limits of the user even if each metric is worse by its error estimate.
///
/// If a verification fails, tightens the cap on K or the limits in `trials` so that the choice is no longer feasible.
/// Writes TunedLaw::verified, edge and error, and the metrics of the choice.
bool is_verified(Trials& trials, TuneTrial& choice, TunedLaw& law);

}  // namespace hapbench
