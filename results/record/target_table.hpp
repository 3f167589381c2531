#pragma once

#include <vector>

#include "results/io/columns.hpp"
#include "results/io/io_error.hpp"
#include "results/io/table_writer.hpp"
#include "results/observe/target_metrics.hpp"

namespace hapbench {

inline constexpr Column kTargetColumns[] = {
    {"subject", "1", "simulated subject, from 0"},
    {"trial", "1", "its trial, from 0"},
    {"target", "1", "target of the trial, from 0"},
    {"place", "1", "where the target was: index of the task's places"},
    {"removed", "1", "1 when the subject removed it, 0 when it disappeared at the time limit"},
    {"time_s", "s", "from the press that activated the task to the end of the target"},
    {"rows_on_target", "1", "rows with the tip on it"},
    {"model_force_N", "N", "mean ||f|| of these rows; empty without any"},
    {"speed_m_per_s", "m/s", "mean speed of the handle in these rows; empty without any"}};

inline constexpr ResultTable kTargetTable = {"targets.csv", "of a tracking hand: one line per target of every trial",
                                             kTargetColumns};

/// targets.csv: what became of every target of every subject's trials, in that order, all counted from 0; `force` and
/// `speed` are means over the rows on target, empty when there was none. Throws IoError.
void write_target_table(TableTarget target, const std::vector<TargetRow>& rows);

}  // namespace hapbench
