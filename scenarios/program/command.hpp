#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/cases/cases.hpp"
#include "scenarios/format/json_file.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "scenarios/program/command_line.hpp"
#include "sim/core/types.hpp"

/// Shared by all commands: exit status, output, common options, names, directories of results, other programs.
namespace hapbench {

/// Exit status of the program.
enum ExitStatus : int {
  kSuccess = 0,
  kInternalFault = 1,
  kBadInput = 2,
  kUnexpectedOutcome = 3,  ///< a simulation diverged, or missed another expectation of its scenario
  kStopped = 128,          ///< plus the number of the signal, as shells do: 130 for Ctrl-C, 143 for SIGTERM
};

/// Runs the command that argv[1], argv[2], ... name and returns the program's exit status. Reports on standard error
/// when a signal (stop_signal.hpp) stopped the work. Throws InputError, also for words that are not a command, and
/// IoError.
int run_program(int argc, char** argv);

/// Does the same, but reports exceptions on standard error: exit status 2 for InputError, 1 for all others.
int run_program_to_exit(int argc, char** argv);

/// Options that most commands have.
struct CommonOptions {
  std::vector<std::string> overrides;
  unsigned jobs = 0;  ///< 0: as many as this process may use
  std::string out;
  OutputOptions output;
};

/// Adds --set, repeatable.
void add_overrides(Command& command, std::vector<std::string>& overrides);
/// Adds --jobs, at least 1. Zero means not given.
void add_jobs(Command& command, unsigned& jobs, const std::string& help = shared_option_help("--jobs"));
/// Adds --out; `name`: of the folder below results/out without it.
void add_out(Command& command, std::string& out, const std::string& name);
/// Adds --algorithms; `otherwise`: those without it.
void add_algorithms(Command& command, std::vector<std::string>& algorithms, const std::string& otherwise);
/// Adds --jobs, --out and --set.
void add_common(Command& command, CommonOptions& options, const std::string& name);

/// Prints `text`, as wide as the output is, or `json` under --json, or nothing under --quiet.
void print(const OutputOptions& options, const std::string& text, const Json& json);
/// Prints warnings, one line each, on standard error.
void print_warnings(const std::vector<std::string>& warnings);
/// The same with the file of each in front.
void print_warnings(const LoadedScenario& loaded, const std::vector<Warning>& warnings);
/// Prints "hapbench: TEXT" on standard error.
void print_note(std::string_view text);
/// Prints "hapbench: error: TEXT" on standard error.
void print_error(std::string_view text);
/// Prints each fault of bad input as an error.
void print_errors(const InputError& error);

/// The first texts, and behind them how many more there are.
std::vector<std::string> first_few(std::vector<std::string> texts, std::size_t most);

/// The output of a command.
struct CapturedOutput {
  std::string text;                           ///< of standard output
  std::vector<std::string> warnings, errors;  ///< notes are among the warnings
};

/// Redirects what the commands of this thread print into `output`, for a host that is not a terminal; null ends that.
void capture_output(CapturedOutput* output) noexcept;
/// Returns the object that collects this thread's output, or null when it is printed.
CapturedOutput* captured_output() noexcept;

/// Draws the run in a folder into a file, FILE.svg. Throws IoError when it cannot be made, after the Python tool has
/// explained why on standard error.
void write_way(const std::filesystem::path& folder, const std::filesystem::path& file, bool quiet);

/// A value as JSON; null for none.
template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Throws InputError unless each name is among the valid ones and given once; `got` stands before the name in its
/// message, as in "--only: got". `shown_by`: a command that shows the valid ones, see quoted_list.
void require_names(std::string_view got, const std::vector<std::string>& names, const std::vector<std::string>& valid,
                   std::string_view shown_by = {});
/// Checks the same way and returns the names, where "all" alone stands for all of them.
std::vector<std::string> chosen_names(std::string_view got, const std::vector<std::string>& given,
                                      const std::vector<std::string>& all, std::string_view shown_by = {});

/// The metric that sweeps and levels show: the one asked for, or else the first of kDefaultMetrics that there is.
/// Throws InputError when there is none of that name.
std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& asked_for);

/// `out`, or results/out/`name` when it is empty.
std::filesystem::path results_directory(const std::string& out, const std::string& name);

/// Throws InputError, which names the option, unless results can be written to `directory`. Creates it, and removes it
/// again if it is still empty when the program ends.
void require_writable_directory(const std::filesystem::path& directory, std::string_view option = "--out");
/// The threads of --jobs, and a progress bar behind `label` unless quiet.
JobOptions job_options(const CommonOptions& options, const std::string& label);

/// Quotes words for a POSIX shell: those with anything but letters, digits and "_-./:=,+@%" in single quotes.
std::string shell_line(const std::vector<std::string>& words);

/// The file of this program, or what set_this_program gave.
std::filesystem::path this_program();
/// Sets the answer of this_program, for a host that is another program.
void set_this_program(std::filesystem::path program);

}  // namespace hapbench
