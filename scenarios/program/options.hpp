#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/program_context.hpp"

namespace hapbench {

/// The options --quiet and --json, which every command has, and --table, which commands with tables have. --wide is in
/// ProgramContext::in_full.
struct OutputOptions {
  bool quiet = false;  ///< true: prints nothing on standard output and shows no progress bar
  bool json = false;   ///< true: prints JSON instead of tables on standard output
  std::string table;   ///< format of --table, which prints only the tables; empty: the text of the terminal
};

/// An option with one meaning in every command that has it.
struct SharedOption {
  std::string_view name, placeholder, help;
  /// Commands of Python packages that have the option. The other commands declare their options themselves.
  std::span<const std::string_view> python_commands = {};
};
/// Returns the shared options in the order of the help.
std::span<const SharedOption> shared_options();
/// Returns the help text of a shared option; empty for other options.
std::string shared_option_help(const std::string& name);

/// Returns true for a shared option that the help of a command only lists by name. The help of the program explains
/// such an option.
bool is_listed_briefly(const std::string& name);

/// Adds --table to a command that prints tables by Report::show().
void add_table(Command& command, OutputOptions& output);

/// Options that most commands have.
struct CommonOptions {
  std::vector<std::string> overrides;
  unsigned jobs = 0;  ///< number of simulations at the same time; 0: the number of threads that this process may use
  std::string out;
  OutputOptions output;
};

// The functions add_overrides, add_jobs, add_out and add_algorithms each add one option; add_common adds
// --jobs, --out and --set.
void add_overrides(Command& command, std::vector<std::string>& overrides);
void add_jobs(Command& command, unsigned& jobs);
/// `name` is the folder below results/out that the command uses without --out.
void add_out(Command& command, std::string& out, const std::string& name);
/// `otherwise` names the algorithms that the command uses without --algorithms.
void add_algorithms(Command& command, std::vector<std::string>& algorithms, const std::string& otherwise);
void add_common(Command& command, CommonOptions& options, const std::string& name);

/// Returns the number of threads that --jobs sets. Without --jobs, returns the number of available threads.
unsigned threads_of(const CommonOptions& options);
/// Returns job options with the threads of --jobs. Without --quiet, they have a progress bar after `label`.
JobOptions job_options(const CommonOptions& options, const std::string& label, const ProgramContext& context);

}  // namespace hapbench
