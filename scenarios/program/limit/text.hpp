#pragma once

#include <string>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/limit/question.hpp"

/// What `limit` prints.
namespace hapbench {

/// The answer in words: the linear edge, or the edge in runs, and what was tried between.
std::string limit_answer(const FieldLimit& found, double resolution);
/// What a run has to do to be stable.
std::string rule_text(const StabilityRule& rule, const Scenario& scenario);
/// The questions, the answers, the table of the rows and the notes on it.
std::string limits_text(const LimitTable& table, const Columns<LimitRow>& columns, const Layout& layout);

}  // namespace hapbench
