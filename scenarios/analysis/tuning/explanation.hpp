#pragma once

#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// Explains why no setting is feasible.
namespace hapbench {

/// Writes into `law` why no setting is feasible: the violated constraint, and the limit to relax. Explains the trial
/// nearest to keeping its limits (Trials::nearest). If there is no such trial, explains a trial that lacks only the
/// margin; if there is none either, the last trial.
void explain(Trials& trials, TunedLaw& law);

}  // namespace hapbench
