#pragma once

#include "scenarios/analysis/tuning/relaxation.hpp"
#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// Explains why no setting is feasible.
namespace hapbench {

/// Writes into `law` why no setting is feasible: the violated constraint, the run that fails, and the limit or option
/// to change. Precondition: the search of `trials` found no feasible trial. A relaxation of limits is named only if
/// `search` finds a choice with the relaxed limits (relaxations()).
void explain(Trials& trials, const VerifiedSearch& search, TunedLaw& law);

}  // namespace hapbench
