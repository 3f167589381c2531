#pragma once

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/report.hpp"

/// The printed ranking of `compare`.
namespace hapbench {

/// Reports the ranking in each scenario by each metric, the table of the algorithms over all scenarios and
/// metrics, and sentences that summarize them. With --table, law_metric_table() replaces the two tables.
void report_ranking_text(const Ranking& ranking, const Layout& layout, Report& report);
/// Returns a note on the algorithm whose fidelity is not ranked (Ranking::shares_reference). Returns an empty text if
/// the fidelity of every algorithm is ranked.
std::string unranked_text(const Ranking& ranking, const Layout& layout);

}  // namespace hapbench
