#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/tuning/trials.hpp"

/// Relaxed limits with which `tune` finds a choice. Used if no setting keeps the limits of the question.
namespace hapbench {

/// Searches with the given limits, and returns a choice that passed its verification; empty if there is no such choice.
/// With `strictest`, the choice has a strict value of this end of a limit (TuneSearch::strictest()); otherwise it has
/// the largest K.
using VerifiedSearch =
    std::function<std::optional<TuneTrial>(const TuneLimits& limits, const std::optional<LimitEnd>& strictest)>;

/// Relaxed limits.
struct Relaxation {
  std::string text;  ///< the changes of the limits, for the user
  TuneTrial choice;  ///< verified choice that keeps the relaxed limits
};

/// Starts a search with these limits, to which all trials of all searches belong. Returns the trial with the smallest
/// excess() that violates only limits, also after a complete evaluation; null if there is no such trial.
const TuneTrial* nearest_to_limits(Trials& trials, const TuneLimits& limits);

/// Returns the relaxations of a single limit with which `search` finds a choice: one for each end of each limit on a
/// metric, and one without the rules of low vibration. If no relaxation of a single limit suffices, returns a
/// relaxation of several limits; empty if `search` does not confirm it.
///
/// The relaxed value of an end does not depend on the value in `limits`: it is the strictest value that the searches
/// reach without this end. A search with a value that is stricter by 4 % fails, unless ten searches succeeded. Two
/// infeasible questions that differ only in this value therefore get the same relaxation. `limits`: the limits of the
/// question. Changes the limits of `trials`.
std::vector<Relaxation> relaxations(Trials& trials, const TuneLimits& limits, const VerifiedSearch& search);

}  // namespace hapbench
