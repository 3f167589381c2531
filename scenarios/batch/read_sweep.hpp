#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/batch/run_sweep.hpp"

namespace hapbench {

/// A finished sweep, read back from its folder.
struct SweepOnRecord {
  SweepPlan plan;      ///< its points, metrics and definition; the scenario's text has no file
  SweepReport report;  ///< of the rows that keep the conditions
};

/// Reads sweep.csv and sweep.json. `conditions` are texts such as "inside_max_m<3e-4": a column, one of < <= > >= = !=,
/// and a number, or with = and != a text; a row without a number in a column keeps no condition on numbers. Throws
/// InputError.
SweepOnRecord read_sweep(const std::filesystem::path& folder, const std::vector<std::string>& conditions);

}  // namespace hapbench
