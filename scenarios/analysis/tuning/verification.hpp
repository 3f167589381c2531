#pragma once

#include <string>

#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// Verifies a choice before it is recommended: between the values that were tried, in longer runs, up to the limit of
/// its own scene, and within the errors of its metrics.
namespace hapbench {

/// Returns the override for K times a factor.
std::string with_gain(const TuneTrial& trial, double gain);

/// Returns the known errors of the metrics of a trial (TunedLaw::error), by runs with half the step, half the distance
/// of the points and the depth evaluated at every step.
TuneMetrics known_errors(Trials& trials, const TuneTrial& trial);

/// Returns true if a choice passes all verifications, in the order of their cost:
/// - settled at 56 gains from 1 to G, in runs of which the families take turns;
/// - stable in the scene's own run up to the limit that `limit` finds, which lies beyond G K;
/// - settled in runs twice as long, unless a script leads on;
/// - keeps limits of the user by as much as its metrics are known.
/// Otherwise no trial that reaches what failed is feasible any more. Writes TunedLaw::verified, edge and error, and the
/// metrics of the choice.
bool is_verified(Trials& trials, TuneTrial& choice, TunedLaw& law);

}  // namespace hapbench
