#pragma once

#include <string>
#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/program/program_context.hpp"

/// `run --replay` and `compare --replay`: pass the recorded inputs of a haptic loop again to the function that rendered
/// its forces (device_model/live/hapbench_renderer.h).
namespace hapbench {

/// Renders the calls of a log again with a scenario, and writes the calls with the new outputs as replay.csv. Compares
/// the new outputs with the recorded outputs. Returns the exit status: kUnexpectedOutcome if the scenario is the
/// recorded scenario and an output differs in any bit. Throws InputError if the scenario or the log is invalid, and
/// IoError if replay.csv cannot be written.
int replay_loop(const std::string& scenario, const std::string& log, const CommonOptions& options,
                ProgramContext& context);
/// Renders the calls of a log with each of the algorithms. Writes and prints a row for each algorithm: its forces, and
/// how they differ from the recorded outputs. Returns the exit status. Throws InputError if the scenario or the log is
/// invalid, and IoError if the table cannot be written.
int compare_replays(const std::string& scenario, const std::string& log, const std::vector<std::string>& algorithms,
                    const CommonOptions& options, ProgramContext& context);

/// Returns the tables that replay_loop() and compare_replays() write and print, for `describe`.
std::vector<DescribedTable> replay_tables();

}  // namespace hapbench
