#pragma once

#include <filesystem>
#include <vector>

#include "results/io/io_error.hpp"
#include "results/observe/target_metrics.hpp"

namespace hapbench {

/// targets.csv: what became of every target of every subject's trials, in that order, all counted from 0; `force` and
/// `speed` are means over the rows on target, empty when there was none. Throws IoError.
void write_target_table(const std::filesystem::path& file, const std::vector<TargetRow>& rows);

}  // namespace hapbench
