#pragma once

#include <string>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/limit/question.hpp"
#include "scenarios/program/report.hpp"

/// The printed text of `limit`.
namespace hapbench {

/// Returns the answer as a clause: the limit to quote with its reason, linear limit, simulated limit, and the number of
/// verification samples.
std::string limit_answer(const FieldLimit& found, const LimitQuestion& question);
/// Returns the condition under which a run counts as stable.
std::string rule_text(const StabilityRule& rule, const Scenario& scenario);
/// Reports the questions, the answers, the table of the rows and the notes on this table.
void report_limits_text(const LimitTable& table, const Columns<LimitRow>& columns, const Layout& layout,
                        Report& report);

}  // namespace hapbench
