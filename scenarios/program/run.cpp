#include "scenarios/program/run.hpp"

#include <iterator>

#include <fmt/format.h>

#include "results/observe/target_metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct RunOptions : CommonOptions {
  std::vector<std::string> scenarios;
  bool latency = false, no_skip = false;
};

/// One directory per scenario: that of --out for a single one, a subdirectory named after the file for several; without
/// --out, one of results/out. Throws InputError when two files have the same name.
std::vector<fs::path> output_directories(const std::string& out, const std::vector<fs::path>& files) {
  std::vector<fs::path> directories;
  for (const std::string& name : names_of_scenarios(files)) {
    const fs::path directory = results_directory(out, name);
    directories.push_back(out.empty() || files.size() == 1 ? directory : directory / name);
  }
  return directories;
}

/// The table of thesis D.4.
Columns<PlaceMetrics> place_columns() {
  const auto mean = [](SubjectMean PlaceMetrics::*of, double factor = 1.0) {
    return [=](const PlaceMetrics& p) {
      const SubjectMean& m = p.*of;
      if (m.subjects == 0) return std::string("-");
      return fmt::format("{} +- {}", deserved(factor * m.mean, 0.1 * factor * m.standard_error, 3),
                         significant(factor * m.standard_error, 2));
    };
  };
  return {
      {"place", "1", "index of the target position, from 0", &PlaceMetrics::place, only_printed()},
      {"success rate", "1", "targets.0.success_rate.mean", mean(&PlaceMetrics::success_rate), only_printed()},
      {"completion [s]", "1", "targets.0.completion_time_s.mean", mean(&PlaceMetrics::completion_time), only_printed()},
      {"model force [N]", "1", "targets.0.model_force_N.mean", mean(&PlaceMetrics::model_force), only_printed()},
      {"speed [mm/s]", "1", "targets.0.speed_m_per_s.mean", mean(&PlaceMetrics::speed, 1e3), only_printed()}};
}

/// The steps of runs that timed them.
Columns<Result> latency_columns() {
  const auto time = [](std::uint64_t StepLatency::*of) {
    return [of](const Result& r) {
      const StepLatency& latency = *r.timing.latency;
      return latency.steps > 0 ? fmt::format("{:.3f}", static_cast<double>(latency.*of) / 1e3) : "-";
    };
  };
  Columns<Result> columns = {
      {"step latency", "", "of run --latency: scenario whose steps were timed", &Result::name, only_printed()},
      {"steps", "1", "", [](const Result& r) { return r.timing.latency->steps; }, only_printed()}};
  for (const auto& [part, of] : {std::pair{"50", &StepLatency::p50},
                                 {"95", &StepLatency::p95},
                                 {"99", &StepLatency::p99},
                                 {"99.9", &StepLatency::p99_9}}) {
    columns.add({{fmt::format("p{} us", part), "us",
                  fmt::format("{} % of the time steps take at most this wall time each [us]", part), time(of),
                  only_printed()}});
  }
  columns.add({{"max us", "us", "wall time of the longest time step [us]", time(&StepLatency::max), only_printed()}});
  for (std::size_t i = 0; i < std::size(kStepDeadlines); ++i) {
    columns.add({{fmt::format("> {:.3f} ms", 1e3 * kStepDeadlines[i]), "1",
                  "number of time steps that took longer than this deadline",
                  [i](const Result& r) { return r.timing.latency->misses[i]; }, only_printed()}});
  }
  columns.add({{"clock us", "us", "wall time of reading the clock, which is included in each step's time [us]",
                time(&StepLatency::overhead), only_printed()}});
  return columns;
}

/// What is wrong with a run and what to try; of several runs a line each, with the names of the rules. May be empty.
std::string diagnosis_text(std::span<const Result> reports, const Layout& layout) {
  std::string text;
  for (const Result& report : reports) {
    std::string rules;
    for (const Diagnosed& found : *report.diagnosis) {
      rules += fmt::format("{}{} ({:.3g})", rules.empty() ? "" : ", ", found.rule, found.value);
      if (reports.size() > 1) continue;
      const std::string unit = found.unit == "1" ? "" : " " + found.unit;
      text += layout.wrapped(
          fmt::format("{} (rule {}: {:.3g} > {:g}{})", found.says, found.rule, found.value, found.threshold, unit), 0);
      text += layout.wrapped("try: " + found.attempt, 2);
    }
    if (reports.size() > 1 && !rules.empty())
      text += layout.wrapped(fmt::format("diagnosis of {}: {}", report.name, rules), 0);
  }
  return text.empty() ? "" : "\n" + text;
}

int run(const RunOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  // All input is checked before anything runs or is written.
  std::vector<std::string> overrides = options.overrides;
  if (options.latency) overrides.emplace_back("record.timing=true");
  std::vector<LoadedScenario> scenarios;
  const std::vector<fs::path> files = find_scenarios(options.scenarios);
  for (const fs::path& file : files) scenarios.push_back(load_scenario(file, overrides));
  const std::vector<fs::path> directories = output_directories(options.out, files);
  for (LoadedScenario& loaded : scenarios) {
    loaded = checked(std::move(loaded));
    if (options.no_skip) loaded.scenario.rendering.skips = Skips::off;
    print_warnings(context, loaded);
  }
  for (const fs::path& directory : directories) require_writable_directory(context, directory);

  const fs::path where = directories.size() == 1 ? directories[0] : directories[0].parent_path();
  Report report(options.output, where, context);
  std::vector<Result> results;
  std::string targets;
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    const Result& result = results.emplace_back(
        run_scenario(scenarios[i], directories[i], !options.output.quiet, nullptr, /*diagnose=*/true));
    // Users who try values of a field hear that the results of the value before are gone.
    if (result.replaces_other && options.out.empty() && !options.overrides.empty())
      print_note(context,
                 fmt::format("replaced the results of a run with other fields in {}; --out DIRECTORY keeps both",
                             directories[i].string()));
    if (result.sections.contains("targets"))
      targets += fmt::format("\n{}: targets, mean +- standard error over subjects\n\n{}", result.name,
                             place_columns().text(place_metrics(result.targets), layout));
    print_warnings(context, run_warnings({&result, 1}));
    Json& summary = report.json().emplace_back(summary_json(result));
    if (options.latency) summary["step_latency"] = step_latency_json(*result.timing.latency);
    for (const std::string& unmet : result.unmet) {
      report.fault(fmt::format(R"({}: {} (field expect; --set expect={{"outcome":"{}"}} accepts this outcome))",
                               scenarios[i].file.string(), unmet, outcome_name(result.end.outcome)),
                   kUnexpectedOutcome);
    }
  }
  const std::string latency_text = options.latency ? "\n" + latency_columns().text(results, layout) : "";
  report.say(run_table(results, true, layout) + fidelity_text(results, layout) + step_time_text(results, layout) +
             targets + latency_text + diagnosis_text(results, layout) +
             fmt::format("\nresults in {}\n", where.string()));
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> single_run_tables() {
  return {place_columns().described(), latency_columns().described()};
}

void add_run(CommandLine& line) {
  auto [command, options] = line.command("run", "Run scenarios, write their results and say what is wrong with them",
                                         run, "nothing of the unfinished run is written; finished runs are kept");
  command.add("scenarios", options.scenarios, "scenario files, names of bundled scenarios, or of groups of them",
              {.required = true});
  command.add("--out", options.out,
              "directory of the results; several scenarios get a subdirectory each (default: results/out/NAME)");
  add_overrides(command, options.overrides);
  command.flag("--latency", options.latency,
               "time every step, as record.timing does, and print percentiles and missed deadlines");
  command.flag("--no-skip", options.no_skip, "compute everything by brute force, even what cannot change the results");
}

}  // namespace hapbench
