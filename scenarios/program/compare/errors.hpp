#pragma once

#include <cstddef>
#include <string>

#include "scenarios/analysis/convergence/finer_runs.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/report.hpp"

/// Reports the errors of the metrics in `compare`, and the differences between force laws that exceed these errors.
namespace hapbench {

/// Reports a table of the metrics of a scenario with their errors, and a sentence on the order of the laws by each
/// metric in the table. `all`: true to include the metrics that the table of runs shows only with --wide or not at all.
/// The JSON always has all metrics.
void report_errors(const Ranking& ranking, const FinerRuns& finer, std::size_t scenario, bool all, Report& report,
                   const Layout& layout);
/// Returns a sentence with the order of the laws by vibration. Differences that a hand cannot feel do not count.
/// Compares the vibration of the force. If a law without failures has no settled contact, compares the vibration of the
/// tool instead. Returns an empty text for a single law.
std::string vibration_text(const Ranking& ranking, const Layout& layout);

}  // namespace hapbench
