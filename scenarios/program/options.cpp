#include "scenarios/program/options.hpp"

#include <algorithm>
#include <iterator>

#include "scenarios/program/table_format.hpp"

namespace hapbench {

namespace {

constexpr std::string_view kPython[] = {"import", "audit", "plot", "report"};
constexpr std::string_view kPrinting[] = {"import", "audit"}, kWithFolder[] = {"audit"};

/// The options that mean the same in several commands.
constexpr SharedOption kSharedOptions[] = {
    {"--set", "<path=value>", "override a field of every scenario, such as time.steps=100; repeatable"},
    {"--out", "<dir>", "folder of the results (default: results/out/NAME, in the current folder)", kWithFolder},
    {"--jobs", "<n>", "number of threads; results do not depend on it (default: all threads)"},
    {"--seed", "<n>", "seed of the random numbers (default: 1)"},
    {"--module", "<file.so>",
     "load a compiled force law or source of contacts; HAPBENCH_MODULE_PATH names folders of such files"},
    {"--allow-modules", "", "load every library that a scenario names; its code can do anything that you can"},
    {"--json", "", "print JSON instead of tables, for scripts", kPrinting},
    {"--table", "<format>",
     "print only the tables, without other text: markdown, latex (packages booktabs and siunitx), or csv"},
    {"--quiet", "", "print nothing on standard output, and no progress", kPython},
    {"--wide", "", "print all columns, also beyond the width of the terminal", kPrinting},
    {"--help", "", "explain the command, with examples", kPython}};

/// Shared options that the help of each command explains in full, because users need them often.
constexpr std::string_view kExplained[] = {"--set", "--jobs"};

}  // namespace

std::span<const SharedOption> shared_options() {
  return kSharedOptions;
}

std::string shared_option_help(const std::string& name) {
  for (const SharedOption& option : kSharedOptions)
    if (option.name == name) return std::string(option.help);
  return "";
}

bool is_listed_briefly(const std::string& name) {
  return std::ranges::find(kSharedOptions, name, &SharedOption::name) != std::end(kSharedOptions) &&
         std::ranges::find(kExplained, name) == std::end(kExplained);
}

void add_table(Command& command, OutputOptions& output) {
  command.add("--table <format>", output.table, shared_option_help("--table"), {.one_of = table_format_names()});
}

void add_overrides(Command& command, std::vector<std::string>& overrides) {
  command.add("--set <path=value>", overrides, shared_option_help("--set"), {.several = true});
}

void add_jobs(Command& command, unsigned& jobs) {
  command.add("--jobs <n>", jobs, shared_option_help("--jobs"), {.range = {{1, 1024}}});
}

void add_out(Command& command, std::string& out, const std::string& name) {
  command.add("--out <dir>", out, "folder of the results (default: results/out/" + name + ")");
}

void add_algorithms(Command& command, std::vector<std::string>& algorithms, const std::string& otherwise) {
  command.add("--algorithms <name,...>", algorithms, "force laws, or all (default: " + otherwise + ")",
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
