#pragma once

#include "scenarios/program/layout.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/tune/answer.hpp"

/// The printed text of `tune`.
namespace hapbench {

/// Reports the question, the recommendation, the table of the laws, and the reason why a law has no feasible
/// choice.
void report_tuning(const Tuning& tuning, const Layout& layout, Report& report);

}  // namespace hapbench
