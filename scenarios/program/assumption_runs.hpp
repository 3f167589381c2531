#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/thesis/judging.hpp"

/// Functions of the command `reproduce` that judge claims under other assumptions than the recorded assumptions.
namespace hapbench {

/// Judges the claims under each assumption set in a file. For each set, reports the claims that its assumptions can
/// change: the verdict and the number under this set, the recorded verdict and number, and whether the verdict differs.
/// Writes the results of runs into `scratch` and removes this folder at the end.
void report_assumption_sets(const std::vector<Claim>& claims, const std::filesystem::path& file,
                            const std::filesystem::path& scratch, const CommonOptions& options, Report& report,
                            ProgramContext& context);

/// Judges each claim of `claims` with one assumption at a time at another plausible value (sensitivity.hpp). Adds the
/// verdicts to the record in a file after each case, so that a repeated command continues an interrupted command.
/// Reports the robustness of each verdict. Removes entries from the record whose claim is not in `all`, the list of all
/// claims.
void record_sensitivity(const std::vector<Claim>& claims, const std::vector<Claim>& all,
                        const std::filesystem::path& file, const std::filesystem::path& scratch,
                        const CommonOptions& options, Report& report, ProgramContext& context);

/// Returns the tables that these functions print, for `describe`.
std::vector<DescribedTable> assumption_tables();

}  // namespace hapbench
