#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/program/command_line.hpp"
#include "sim/core/types.hpp"

/// The command line: each command adds its options to the parser and says what to do when it is chosen.
namespace hapbench {

/// Exit status of the program.
enum ExitStatus : int {
  kSuccess = 0,
  kInternalFault = 1,
  kBadInput = 2,
  kUnexpectedOutcome = 3,  ///< a simulation diverged, or missed another expectation of its scenario
  kStopped = 128,          ///< plus the number of the signal, as shells say it: 130 for Ctrl-C, 143 for SIGTERM
};

/// Options every command understands.
struct OutputOptions {
  bool quiet = false;  ///< nothing on standard output, no progress bar
  bool json = false;   ///< JSON instead of tables on standard output
};

void add_run(CommandLine& line);
void add_compare(CommandLine& line);
void add_stability(CommandLine& line);
void add_limit(CommandLine& line);
void add_precision(CommandLine& line);
void add_reproduce(CommandLine& line);
void add_diff(CommandLine& line);
void add_sweep(CommandLine& line);
void add_merge(CommandLine& line);
void add_new(CommandLine& line);
void add_import(CommandLine& line);
void add_plot(CommandLine& line);
void add_report(CommandLine& line);
void add_shell(CommandLine& line);
void add_list(CommandLine& line);
void add_describe(CommandLine& line);
void add_validate(CommandLine& line);
void add_completion(CommandLine& line);
void add_man(CommandLine& line);

/// Adds --quiet, --json and --wide.
void add_output_options(Command& command, OutputOptions& options);

/// Adds --no-skip.
void add_skip_option(Command& command, Skips& skips);

/// Prints `text`, as wide as the output is, or `json` under --json, or nothing under --quiet.
void print(const OutputOptions& options, const std::string& text, const Json& json);

/// What a command says.
struct CapturedOutput {
  std::string text;                           ///< of standard output
  std::vector<std::string> warnings, errors;  ///< notes are among the warnings
};

/// From now on what the commands of this thread say goes there; null: to the terminal. For a host that is no terminal.
void capture_output(CapturedOutput* output) noexcept;

/// Prints warnings, one line each, on standard error.
void print_warnings(const std::vector<std::string>& warnings);

/// Prints "hapbench: TEXT" on standard error.
void print_note(std::string_view text);

/// Prints "hapbench: error: TEXT" on standard error.
void print_error(std::string_view text);
/// Prints the faults of bad input so, a line each.
void print_errors(const InputError& error);

/// The page that `report` writes of the runs in a folder. Throws IoError when it cannot be made; what is missing has
/// then been said on standard error.
void write_report(const std::filesystem::path& folder, bool quiet);

/// Says on standard error when results are going to be large: more than 100 MB.
void announce_large_output(double bytes);

/// The names of all registered algorithms.
std::vector<std::string> all_algorithms();

/// Makes sure the names given are among the valid ones, each once; throws InputError otherwise, in whose message `got`
/// stands before the name, as in "--only: got".
void require_names(std::string_view got, const std::vector<std::string>& names, const std::vector<std::string>& valid);
/// The same where "all" may be given instead of names, and stands for all of them; returns the names.
std::vector<std::string> chosen_names(std::string_view got, const std::vector<std::string>& given,
                                      const std::vector<std::string>& all);
/// The same for the names given to --algorithms.
void require_algorithms(const std::vector<std::string>& names);

/// One directory a scenario: `out` itself for a single one, a subdirectory named after the file for several; without
/// `out`, one of results/out, named after the file behind `prefix`. Throws InputError when two files have the same
/// name; `allowed` is for its message.
std::vector<std::filesystem::path> output_directories(const std::string& out,
                                                      const std::vector<LoadedScenario>& scenarios,
                                                      const std::string& prefix, const std::string& allowed);

/// Makes sure results can be written to `directory`; throws InputError otherwise. Creates it; if it is still empty when
/// the program ends, it is removed again.
void require_writable_directory(const std::filesystem::path& directory);

}  // namespace hapbench
