#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>
#include <set>
#include <span>

#include "algorithms/registry.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/batch/earlier_results.hpp"
#include "scenarios/batch/league_files.hpp"
#include "scenarios/batch/league_runs.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/run_batch.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/program/compare_devices.hpp"
#include "scenarios/program/comparison_table.hpp"
#include "scenarios/program/device_limits_text.hpp"
#include "scenarios/program/league_text.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/expectation.hpp"
#include "scenarios/run/expected_output.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  std::vector<std::string> scenarios;
  std::vector<std::string> algorithms;
  std::vector<std::string> metrics;
  unsigned seeds = 1;
  double jitter = 0.0;
  unsigned jobs = 0;  ///< 0: not given
  std::string out;
  std::vector<std::string> overrides;
  bool html = false;
  Skips skips = Skips::taken;
  OutputOptions output;
  std::vector<std::string> devices;
  std::string vibration;
  std::string resolution;
};

/// --devices asks for something else: the largest stiffness that each of them renders.
CompareDevicesOptions device_options(const CompareOptions& options) {
  if (options.skips == Skips::off) throw InputError("--no-skip: got it beside --devices; allowed: without");
  return {options.devices,    options.scenarios, options.algorithms, options.overrides, options.vibration,
          options.resolution, options.jobs,      options.out,        options.output};
}

/// There is something to rank over, or by.
bool wants_league(const CompareOptions& options, const BatchPlan& plan) {
  return plan.scenarios.size() > 1 || options.seeds > 1 || !options.metrics.empty();
}

BatchPlan plan_of(const CompareOptions& options) {
  if (!options.metrics.empty()) require_names("--by: got", options.metrics, metric_names());
  constexpr double kMostJitter = 1.0;
  if (!(options.jitter >= 0.0 && options.jitter <= kMostJitter)) {
    throw InputError(fmt::format("--jitter: got {}; allowed: 0 ... {} m", options.jitter, kMostJitter));
  }
  BatchDefinition definition;
  if (!options.algorithms.empty()) {
    definition.algorithms = chosen_names("--algorithms: got", options.algorithms, all_algorithms());
  } else {
    definition.algorithms = all_algorithms();
  }
  definition.scenarios = find_scenarios(options.scenarios);
  definition.overrides = options.overrides;
  definition.seeds = options.seeds;
  definition.jitter = options.jitter;
  definition.skips = options.skips;
  return plan_batch(std::move(definition));
}

fs::path directory_of(const CompareOptions& options, const BatchPlan& plan) {
  if (!options.out.empty()) return options.out;
  return fs::path("results") / "out" / (plan.names.size() > 1 ? "compare" : "compare_" + plan.names[0]);
}

/// Makes the directories and takes out of them what an earlier comparison left.
void prepare(const fs::path& out, const BatchPlan& plan, bool league) {
  ResultList results;
  for (std::size_t i = 0; i < plan.size(); ++i) results.runs.push_back(run_directory(plan, i));
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    results.tables.push_back(scenario_directory(plan, s) / "comparison.csv");
  }
  if (league) results.tables.emplace_back("league.csv");
  for (const fs::path& run : results.runs) require_writable_directory(out / run);
  replace_earlier_results(out, results);
}

double expected_bytes(const BatchPlan& plan) {
  const std::size_t each = plan.size() / plan.scenarios.size();
  double bytes = 0.0;
  for (std::size_t i = 0; i < plan.size(); i += each)
    bytes += static_cast<double>(each) * expected_output_bytes(scenario_of(plan, i).scenario);
  return bytes;
}

BatchOptions batch_options(const CompareOptions& options, const BatchPlan& plan, const fs::path& out) {
  BatchOptions batch;
  batch.directory = out;
  // The table of a single comparison shows times, which runs beside each other would lengthen.
  batch.jobs = options.jobs > 0 ? options.jobs : wants_league(options, plan) ? available_threads() : 1;
  batch.progress = !options.output.quiet;
  return batch;
}

/// The reports of one scenario.
std::span<const RunReport> reports_of(const BatchPlan& plan, const BatchReport& report, std::size_t scenario) {
  const std::size_t each = plan.size() / plan.scenarios.size();
  return std::span(report.runs).subspan(scenario * each, each);
}

/// What one scenario's runs came to, for the terminal.
std::string comparison_text(std::span<const RunReport> reports) {
  std::vector<Table::Column> columns = run_columns();
  columns.insert(columns.begin(), {"algorithm", false});
  Table table(columns, kRunGap);
  for (const RunReport& report : reports) {
    std::vector<std::string> cells = run_cells(report);
    cells.insert(cells.begin(), report.summary.algorithm);
    table.add(std::move(cells));
  }
  return fmt::format("{}\n\n{}{}{}", reports.front().summary.name, table.text(), unsettled_text(reports),
                     step_time_text(reports));
}

/// Which algorithms of a single scenario are defined with a depth model other than the one that others have. A run of
/// theirs would warn of it.
std::string own_depth_models_text(const BatchPlan& plan) {
  std::vector<std::string> own;
  std::set<std::string> models;
  for (std::size_t i = 0; i < plan.size(); i += plan.definition.seeds) {
    const Scenario scenario = scenario_of(plan, i).scenario;
    if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) return "";
    const RenderingConfig& rendering = scenario.rendering;
    models.insert(rendering.depth_model);
    if (!find_algorithm(rendering.algorithm)->fixed_depth_model.empty())
      own.push_back(fmt::format("{} with {}", rendering.algorithm, rendering.depth_model));
  }
  if (models.size() < 2) return "";
  return wrapped(fmt::format("defined with a depth model of their own: {}", fmt::join(own, ", ")), 0);
}

Json summaries_json(const BatchPlan& plan, const BatchReport& report, bool league) {
  Json summaries = Json::array();
  for (std::size_t i = 0; i < plan.size(); ++i) {
    Json summary = summary_json(report.runs[i].summary);
    if (league) {
      const BatchRun run = plan.run(i);
      Json named = {{"scenario", plan.names[run.scenario]}, {"seed", run.seed}};
      named.update(summary);
      summary = std::move(named);
    }
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

/// Tells of runs that diverge although their scenario does not expect it, the only expectation that concerns every
/// algorithm: each of a single comparison, of a batch the first. Returns the exit status.
int verdict(const BatchPlan& plan, const BatchReport& report, bool league) {
  std::size_t count = 0;
  std::string first;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const RunSummary& summary = report.runs[i].summary;
    const BatchRun run = plan.run(i);
    if (summary.result.outcome != Outcome::diverges ||
        outcome_is_expected(scenario_of(plan, i).scenario.expect, Outcome::diverges)) {
      continue;
    }
    const Divergence& d = summary.result.divergence;
    const std::string text = fmt::format("{}: {} diverges at step {}{}", plan.scenarios[run.scenario].file.string(),
                                         summary.algorithm, d.step, d.fault.empty() ? "" : ": " + d.fault);
    if (!league) print_error(text);
    if (count++ == 0) first = text;
  }
  if (league && count > 0) {
    print_error(fmt::format("{} of {} runs diverge, the first: {}", count, plan.size(), first));
  }
  return count > 0 ? kUnexpectedOutcome : kSuccess;
}

int compare(const CompareOptions& options) {
  if (!options.devices.empty()) return compare_devices(device_options(options));
  if (options.scenarios.empty())
    throw InputError("compare: scenarios is required; \"hapbench compare --help\" explains");
  // All input is checked before anything runs or is written.
  const BatchPlan plan = plan_of(options);
  const fs::path out = directory_of(options, plan);
  print_warnings(plan.warnings);
  prepare(out, plan, wants_league(options, plan));
  announce_large_output(expected_bytes(plan));

  const BatchReport report = [&] {
    try {
      return run_batch(plan, batch_options(options, plan, out));
    } catch (const Stopped&) {
      forget_results_if_none(out);
      throw;
    }
  }();
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    print_warnings(run_warnings(reports_of(plan, report, s)));
    write_comparison(out / scenario_directory(plan, s) / "comparison.csv", reports_of(plan, report, s), options.seeds);
  }
  const std::string where = fmt::format("\nresults in {}\n", out.string());
  Json json = summaries_json(plan, report, wants_league(options, plan));
  if (wants_league(options, plan)) {
    const League league = make_league(league_runs(plan, report, options.metrics));
    write_league(out / "league.csv", league);
    Json batch = {{"runs", std::move(json)}};
    batch.update(league_json(league));
    print(options.output, league_text(league) + where, batch);
  } else {
    print(options.output, comparison_text(report.runs) + own_depth_models_text(plan) + where, json);
  }
  if (options.html) write_report(out, options.output.quiet || options.output.json);
  return verdict(plan, report, wants_league(options, plan));
}

}  // namespace

void add_compare(CommandLine& line) {
  auto options = std::make_shared<CompareOptions>();
  Command command =
      line.command("compare", "Run scenarios through several algorithms, side by side; of several, a league table");
  command.add("scenarios", options->scenarios,
              "scenario files, names of bundled scenarios, or of groups of them (with --devices default: " +
                  fmt::format("{}", fmt::join(default_device_scenes(), " ")) + ")");
  command
      .add("--algorithms", options->algorithms,
           "names, separated by commas, or all (default: all; with --devices shaped_stiffness,summation)")
      .comma_separated();
  const CommandOption devices =
      command
          .add(
              "--devices", options->devices,
              "instead: the largest stiffness that each of these devices renders stably and quietly: ideal, admittance, "
              "presets of \"hapbench list presets\", impedance for all of these, or all; NAME.json is a file with a device of "
              "your own")
          .comma_separated();
  command
      .add("--vibration", options->vibration,
           fmt::format("with --devices: most vibration of the handle above 30 Hz [m/s rms] (default: {})",
                       kMostVibration))
      .needs(devices);
  command.add("--resolution", options->resolution, "with --devices: relative width of a limit (default: 0.01)")
      .needs(devices);
  command.add("--seeds", options->seeds, "run each K times, time k with the scenario's seed + k (default: 1)")
      .range(1, 10'000)
      .excludes(devices);
  command
      .add("--jitter", options->jitter,
           "shift the start by a vector of this length [m] whose direction the seed gives, the same for all "
           "algorithms: a spread where nothing else is random")
      .excludes(devices);
  command
      .add("--by", options->metrics,
           "metrics of the league, less is better: names of summary.json, separated by commas (default: " +
               default_metrics_text() + "; fidelity where every scene has a reference force)")
      .comma_separated()
      .excludes(devices);
  command.add("--jobs", options->jobs, "runs at once (default: one per thread; 1 where the table shows times)")
      .range(1, 1024);
  command.add(
      "--out", options->out,
      "directory of the results (default: results/out/compare_NAME, of several scenarios results/out/compare, of "
      "devices results/out/compare_devices)");
  command.add("--set", options->overrides, "override a field: path=value").repeatable();
  command.flag("--html", options->html, "write OUT/report.html as well: curves, replay, metrics, commands")
      .excludes(devices);
  add_skip_option(command, options->skips);
  add_output_options(command, options->output);
  command.footer(
      "Files go to OUT/[SCENARIO/]ALGORITHM[/seed_K], the parts in brackets where there are several; comparison.csv "
      "for each scenario. With several scenarios or seeds, or --by, a league: rank, ratio to the best, mean and spread "
      "over the seeds, whether a difference is more than the spread, and where each algorithm wins and fails; all of "
      "it in league.csv. A run fails that diverges, has no contact or loses it, is not dragged, or ends otherwise than its scenario "
      "allows; it ranks behind all others. What an earlier comparison left in OUT is removed, other files are not.\n"
      "With --devices K is bisected as \"hapbench limit\" does it, for each device, scene and algorithm; the published "
      "stiffness stands beside it, and below it each K over that of the first scene with the first algorithm, beside 1 / "
      "lambda_max(S) and the contacts of the run at that K. Other fields stay those of the scene, also the rule by which B follows K, and --set "
      "changes them for all devices. A hand with a mass loses it on ideal and admittance, where the virtual mass stands for it. Files: "
      "device_limits.csv and device_runs.csv; \"hapbench plot OUT\" draws them.");
  command.runs([options] { return compare(*options); }, "the folders of finished runs are kept, no table is written");
}

}  // namespace hapbench
