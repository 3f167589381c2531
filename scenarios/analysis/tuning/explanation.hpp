#pragma once

#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// Explains why no setting is feasible.
namespace hapbench {

/// Writes into `law` why no setting is feasible: the violated constraint, and the limit to relax. Explains the trial
/// that is nearest to keeping its limits (Trials::nearest). If no trial violates only limits, explains a trial that
/// lacks only the gain margin. If there is no such trial either, explains the last trial.
void explain(Trials& trials, TunedLaw& law);

}  // namespace hapbench
