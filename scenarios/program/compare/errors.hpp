#pragma once

#include <cstddef>
#include <string>

#include "scenarios/analysis/convergence/finer_runs.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/report.hpp"

/// Errors of the numbers of `compare`, and which differences between laws are larger than these errors.
namespace hapbench {

/// Reports a table of the metrics of a scenario with their errors, and a sentence on the order of the laws by
/// each metric in the table. `all` includes metrics that the table of runs shows only with --wide or not at
/// all. The JSON always has all metrics.
void report_errors(const Ranking& ranking, const FinerRuns& finer, std::size_t scenario, bool all, Report& report,
                   const Layout& layout);
/// Returns a sentence with the order of the laws by vibration, as far as the differences exceed what a hand can
/// feel. Compares the vibration of the force; if a law without failures has no settled contact, compares the
/// vibration of the tool.
std::string vibration_text(const Ranking& ranking, const Layout& layout);

}  // namespace hapbench
