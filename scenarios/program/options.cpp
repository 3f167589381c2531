#include "scenarios/program/options.hpp"

namespace hapbench {

namespace {

/// What commands have in common, as far as it means something to them.
constexpr SharedOption kSharedOptions[] = {
    {"--set", "override a field of every scene: path=value, as in time.steps=100; repeatable"},
    {"--out", "where the results go (default: results/out/NAME); a command's help has its own"},
    {"--jobs", "runs at once; no result depends on it (default: one per thread)"},
    {"--seed", "of the random numbers, for another sample (default: 1)"},
    {"--module", "load FILE.so, which holds a force law of your own; HAPBENCH_MODULE_PATH names folders of such files"},
    {"--json", "print JSON instead of tables, for a script"},
    {"--quiet", "print nothing on standard output, and no progress"},
    {"--wide", "print tables in full width, however narrow the terminal is"},
    {"--help", "explain the command, with examples"}};

}  // namespace

std::span<const SharedOption> shared_options() {
  return kSharedOptions;
}

std::string shared_option_help(const std::string& name) {
  for (const auto& [option, help] : kSharedOptions)
    if (option == name) return std::string(help);
  return "";
}

void add_overrides(Command& command, std::vector<std::string>& overrides) {
  command.add("--set", overrides, shared_option_help("--set"), {.several = true});
}

void add_jobs(Command& command, unsigned& jobs) {
  command.add("--jobs", jobs, shared_option_help("--jobs"), {.range = {{1, 1024}}});
}

void add_out(Command& command, std::string& out, const std::string& name) {
  command.add("--out", out, "directory of the results (default: results/out/" + name + ")");
}

void add_algorithms(Command& command, std::vector<std::string>& algorithms, const std::string& otherwise) {
  command.add("--algorithms", algorithms, "names separated by commas, or all (default: " + otherwise + ")",
              {.comma_separated = true});
}

void add_common(Command& command, CommonOptions& options, const std::string& name) {
  add_jobs(command, options.jobs);
  add_out(command, options.out, name);
  add_overrides(command, options.overrides);
}

unsigned threads_of(const CommonOptions& options) {
  return options.jobs == 0 ? static_cast<unsigned>(available_threads()) : options.jobs;
}

JobOptions job_options(const CommonOptions& options, const std::string& label, const ProgramContext& context) {
  return {threads_of(options), options.output.quiet ? "" : label, context.progress};
}

}  // namespace hapbench
