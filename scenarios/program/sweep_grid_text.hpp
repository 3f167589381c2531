#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/sweep_table.hpp"

namespace hapbench {

/// A sweep of two fields by one metric: a table with a row for each value of one field and a column for each of the
/// other, and the same as a map of characters. Fields of texts get the rows. Where a run failed (is_failure, or an
/// error) stands its outcome. Empty when the points are no grid of two fields, when rows are missing (a shard), and for
/// more than 400 cells; the map alone is left out when it is wider than the terminal. Precondition: `metric` is among
/// the plan's.
std::string grid_text(const SweepPlan& plan, const std::vector<SweepRow>& rows, std::string_view metric);

}  // namespace hapbench
