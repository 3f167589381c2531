#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {

/// The columns of comparison.csv: algorithm, outcome, steps, and the metrics that tell algorithms apart.
std::vector<Column> comparison_columns();

/// comparison.csv: a line for each run of one scene, without times: the same comparison gives the same bytes. With
/// several seeds, which follow each other within an algorithm, a column in front tells them apart. Throws IoError.
void write_comparison(const std::filesystem::path& file, std::span<const RunReport> reports, std::size_t seeds = 1);

}  // namespace hapbench
