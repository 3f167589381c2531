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

/// --quiet, --json and --wide, options of every command.
struct OutputOptions {
  bool quiet = false;  ///< nothing on standard output, no progress bar
  bool json = false;   ///< JSON instead of tables on standard output
};

/// An option that means the same in every command that has it.
struct SharedOption {
  std::string_view name, placeholder, help;
};
/// In the order of the help.
std::span<const SharedOption> shared_options();
/// The help of a shared option; empty for other options.
std::string shared_option_help(const std::string& name);

/// Returns true for a shared option that the help of a command names without explaining it.
bool is_listed_briefly(const std::string& name);

/// Options that most commands have.
struct CommonOptions {
  std::vector<std::string> overrides;
  unsigned jobs = 0;  ///< 0: as many as this process may use
  std::string out;
  OutputOptions output;
};

// Each adds an option, add_common all three of CommonOptions.
void add_overrides(Command& command, std::vector<std::string>& overrides);
void add_jobs(Command& command, unsigned& jobs);
/// `name`: of the folder below results/out without the option.
void add_out(Command& command, std::string& out, const std::string& name);
/// `otherwise`: those without the option.
void add_algorithms(Command& command, std::vector<std::string>& algorithms, const std::string& otherwise);
void add_common(Command& command, CommonOptions& options, const std::string& name);

/// The threads of --jobs.
unsigned threads_of(const CommonOptions& options);
/// The threads of --jobs, and a progress bar behind `label` unless quiet.
JobOptions job_options(const CommonOptions& options, const std::string& label, const ProgramContext& context);

}  // namespace hapbench
