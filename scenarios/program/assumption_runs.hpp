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

/// Judges each claim of `claims` with one assumption at a time at another plausible value. Each such value of an
/// assumption is a case (sensitivity.hpp). After each case, writes its verdicts into the sensitivity record `file`, so
/// that a repeated command continues an interrupted command. Reports the robustness of each verdict. Removes the
/// entries of claims that are not in `all`, the list of all claims, from the record.
void record_sensitivity(const std::vector<Claim>& claims, const std::vector<Claim>& all,
                        const std::filesystem::path& file, const std::filesystem::path& scratch,
                        const CommonOptions& options, Report& report, ProgramContext& context);

/// Returns the tables that report_assumption_sets() and record_sensitivity() print, for `describe`.
std::vector<DescribedTable> assumption_tables();

}  // namespace hapbench
