#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/thesis/judging.hpp"

/// The parts of `reproduce` that judge claims under other assumptions.
namespace hapbench {

/// Judges the claims under the assumption sets of a file, and reports for each set the claims that its assumptions can
/// change: verdict and number, the stored verdict and number, and the change. Uses `scratch` for results of runs and
/// removes it.
void report_assumption_sets(const std::vector<Claim>& claims, const std::filesystem::path& file,
                            const std::filesystem::path& scratch, const CommonOptions& options, Report& report,
                            ProgramContext& context);

/// Judges the claims with one assumption at a time at another value (sensitivity.hpp), and adds the verdicts to the
/// record in a file after each case, so that an interrupted command continues. Reports the robustness of each verdict.
/// Claims that are not among `claims` keep their entries; `all` is the list of all claims.
void record_sensitivity(const std::vector<Claim>& claims, const std::vector<Claim>& all,
                        const std::filesystem::path& file, const std::filesystem::path& scratch,
                        const CommonOptions& options, Report& report, ProgramContext& context);

/// The printed tables, for `describe`.
std::vector<DescribedTable> assumption_tables();

}  // namespace hapbench
