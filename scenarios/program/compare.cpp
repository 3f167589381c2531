#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "results/summary/outcome_names.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/comparison_table.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/expectation.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  std::string scenario;
  std::vector<std::string> algorithms;
  std::string out;
  std::vector<std::string> overrides;
  bool no_cache = false;
  Skips skips = Skips::taken;
  OutputOptions output;
};

int compare(const CompareOptions& options) {
  require_algorithms(options.algorithms);
  const std::vector<std::string> algorithms = options.algorithms.empty() ? all_algorithms() : options.algorithms;
  const fs::path file = find_scenario(options.scenario);
  std::vector<LoadedScenario> scenarios;
  for (const std::string& algorithm : algorithms) {
    std::vector<std::string> overrides = options.overrides;
    overrides.push_back("rendering.algorithm=" + algorithm);
    scenarios.push_back(load_scenario(file, overrides));
    scenarios.back().scenario.rendering.skips = options.skips;
    const std::vector<std::string> warnings = check_named_files(scenarios.back());
    // All have the same files.
    if (scenarios.size() == 1) print_warnings(warnings);
  }
  const fs::path out =
      options.out.empty() ? fs::path("results") / "out" / ("compare_" + file.stem().string()) : fs::path(options.out);
  for (const std::string& algorithm : algorithms) require_writable_directory(out / algorithm);

  std::vector<Table::Column> columns = run_columns();
  columns.insert(columns.begin(), {"algorithm", false});
  Table table(columns, kRunGap);
  Json summaries = Json::array();
  std::vector<RunReport> reports;
  const ShellCache cache = shell_cache(options.no_cache || options.skips == Skips::off);
  int status = kSuccess;
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    RunReport report = run_scenario(scenarios[i], out / algorithms[i], !options.output.quiet, cache);
    std::vector<std::string> cells = run_cells(report);
    cells.insert(cells.begin(), report.summary.algorithm);
    table.add(std::move(cells));
    summaries.push_back(summary_json(report.summary));
    // The scenario's other expectations are about its own algorithm; a divergence concerns every one.
    const Outcome outcome = report.summary.result.outcome;
    if (outcome == Outcome::diverges && !outcome_is_expected(scenarios[i].scenario.expect, outcome)) {
      fmt::print(stderr, "hapbench: {}: {} diverges at step {}\n", file.string(), algorithms[i],
                 report.summary.result.divergence.step);
      status = kUnexpectedOutcome;
    }
    reports.push_back(std::move(report));
  }
  write_comparison(out / "comparison.csv", reports);
  print(options.output,
        fmt::format("{}\n\n{}{}{}\nresults in {}\n", scenarios[0].scenario.name, table.text(), friction_text(reports),
                    reduction_text(reports), out.string()),
        summaries);
  return status;
}

}  // namespace

void add_compare(CommandLine& line) {
  auto options = std::make_shared<CompareOptions>();
  Command command = line.command("compare", "Run one scenario through several algorithms, side by side");
  command.add("scenario", options->scenario, "scenario file, or name of a bundled scenario").required();
  command.add("--algorithms", options->algorithms, "names, separated by commas (default: all)").comma_separated();
  command.add("--out", options->out, "directory of the results (default: results/out/compare_NAME)");
  command.add("--set", options->overrides, "override a field: path=value").repeatable();
  add_cache_option(command, options->no_cache);
  add_skip_option(command, options->skips);
  add_output_options(command, options->output);
  command.runs([options] { return compare(*options); });
}

}  // namespace hapbench
