#pragma once

#include <string>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/layout.hpp"

/// The printed ranking of `compare`.
namespace hapbench {

/// Returns the ranking in each scenario by each metric, the table of the algorithms over all scenarios and
/// metrics, and sentences that summarize them.
std::string ranking_text(const Ranking& league, const Layout& layout);
/// Returns a note on the algorithm whose fidelity is not ranked (Ranking::shares_reference); empty if there is none.
std::string unranked_text(const Ranking& league, const Layout& layout);

}  // namespace hapbench
