#pragma once

#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// Explains why no setting is feasible.
namespace hapbench {

/// Writes into `law` why no setting is feasible: the violated constraint, the run that fails, and the limit or option
/// to change. Precondition: the search of `trials` found no feasible trial. `is_feasible` searches with the given
/// limits and returns true if the search finds a verified choice. A relaxation of limits is named only if `is_feasible`
/// returns true for the relaxed limits.
void explain(Trials& trials, const std::function<bool(const TuneLimits& limits)>& is_feasible, TunedLaw& law);

}  // namespace hapbench
