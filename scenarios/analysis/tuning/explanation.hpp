#pragma once

#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// Explains why no setting is feasible.
namespace hapbench {

/// Writes into the answer why nothing is feasible: the constraint that is violated, and the limit to relax. If no limit
/// is violated alone, explains a trial that lacks only the margin, or else the last trial.
void explain(Trials& trials, TunedLaw& law);

}  // namespace hapbench
