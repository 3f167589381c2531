#pragma once

#include <string>
#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/program/program_context.hpp"

/// `run --replay` and `compare --replay`: feed the log of a haptic loop to the function that rendered it
/// (device_model/live/hapbench_renderer.h).
namespace hapbench {

/// Renders the calls of a log again with a scenario, writes them as replay.csv, and compares them with the recorded
/// outputs. Throws InputError and IoError. Returns the exit status: kUnexpectedOutcome if the scenario is the recorded
/// one and a bit differs.
int replay_loop(const std::string& scenario, const std::string& log, const CommonOptions& options,
                ProgramContext& context);
/// Renders the calls of a log with several algorithms, and writes and prints a row for each of them.
int compare_replays(const std::string& scenario, const std::string& log, const std::vector<std::string>& algorithms,
                    const CommonOptions& options, ProgramContext& context);

/// Returns the tables that these functions write and print, for `describe`.
std::vector<DescribedTable> replay_tables();

}  // namespace hapbench
