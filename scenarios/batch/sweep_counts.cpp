#include "scenarios/batch/sweep_counts.hpp"

#include "scenarios/batch/sweep_row.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

void SweepCounts::add(const SweepPlan& plan, std::size_t run, std::string_view row) {
  const std::size_t outcome_column = 1 + plan.points.axes().size();
  const Words cells = parts_of(row, ',');
  const std::string_view outcome = cells[outcome_column];
  const bool is_failure = outcome == kErrorOutcome, is_expected = cells[outcome_column + 1] == "true";
  ++runs;
  Count& count = outcomes[std::string(outcome)];
  ++count.runs;
  if (is_expected) ++count.expected;
  if (is_failure) ++failed;
  if (is_failure || is_expected) return;
  ++unexpected;
  if (!first_unexpected) first_unexpected = run;
}

}  // namespace hapbench
