#include "scenarios/program/converge.hpp"
#include "scenarios/input/shell_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/analysis/convergence/observed_order.hpp"
#include "scenarios/analysis/current_value.hpp"
#include "scenarios/analysis/stability/field_limit.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/batch/sweep_plan.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/describe/fields.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/work_precision.hpp"
#include "scenarios/run/bare_run.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr const char *kOrders = "converge.csv", *kLevels = "converge_levels.csv",
                     *kTimes = "converge_levels_timing.csv";
constexpr double kLargestRatio = 10.0;
constexpr int kLevelsOfMetrics = 5, kLevelsOfSettings = 4;  ///< default numbers of levels, without and with --over
constexpr double kMaxRequestedError = 0.01;                 ///< largest --to with --over [m]; more is in another unit
constexpr double kRequestedError = 1e-6;                    ///< default of --to with --over [m]

struct ConvergeOptions : CommonOptions {
  std::string scenario;
  std::vector<std::string> metrics;
  std::string field = kStepPath;
  std::vector<std::string> over;  ///< axes of a work-precision study; empty: the convergence of metrics
  int levels = 0;                 ///< number of levels; 0: the default number
  double ratio = 2.0;
  std::string to;
};

/// The run of one level, and its processor time [s].
struct LevelRun {
  Result result;
  double seconds = 0.0;
};

/// A row of converge_levels.csv: one metric at one level.
struct LevelRow {
  std::string metric, value, outcome;
  std::optional<double> result, order, error;
  double seconds;
  std::optional<double> share = {};  ///< estimated error divided by the finest result
};

/// The convergence of one metric over all levels.
struct ConvergeStudy : Convergence {
  std::string metric, field;
  double formal_order;
  std::vector<LevelRow> levels;
};

/// Evaluates the convergence of a metric over the runs of all levels.
ConvergeStudy convergence_study(const LevelSweep& levels, const std::vector<LevelRun>& runs,
                                const std::string& metric) {
  std::vector<LevelResult> results;
  for (std::size_t i = 0; i < runs.size(); ++i) results.push_back(level_result(levels, i, runs[i].result, metric));
  const MetricTraits traits = traits_of(runs.front().result.metrics, metric);
  ConvergeStudy study{convergence_of(levels, results, traits), metric, levels.axis.path, levels.formal_order, {}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    LevelRow& row =
        study.levels.emplace_back(LevelRow{metric, levels.axis.values[i], results[i].outcome, results[i].result,
                                           study.orders[i], study.errors[i], runs[i].seconds});
    if (row.error && *results.back().result != 0.0) row.share = *row.error / std::abs(*results.back().result);
  }
  return study;
}

/// Returns a result with the digits that are significant at its error, six if the error is 0.
std::string result_text(double value, const std::optional<double>& error) {
  return error && *error == 0.0 ? significant(value, 6) : deserved(value, error);
}

/// Returns the columns of the levels. `study` provides the field and metric for the printed headings.
Columns<LevelRow> level_columns(const ConvergeStudy& study) {
  using Row = LevelRow;
  const auto value = [](const Row& r) { return finite_number(r.value); };
  const auto result = [](const Row& r) { return r.result ? result_text(*r.result, r.error) : "-"; };
  const auto order = [has_order = study.order.has_value()](const Row& r) {
    return has_order && r.order ? fmt::format("{:.2f}", *r.order) : "-";
  };
  const auto percent = [](const Row& r) { return r.share ? significant(100.0 * *r.share, 2) : "-"; };
  return {
      {"metric", "", "name of the metric", &Row::metric, kOnlyCsv},
      {"value", "unit of the field", "value of the refined field at this level", value},
      {study.field, field_unit(study.field), "", [](const Row& r) { return axis_cell(r.value); },
       varied(only_printed())},
      {"outcome", "", "outcome of the run", &Row::outcome, under("outcome")},
      {"result", "unit of the metric",
       "value of the metric, sampled at the times of the coarsest level's steps; empty if the run has no value or "
       "diverges",
       &Row::result},
      {study.metric, metric_unit(study.metric), "", result, only_printed()},
      {"observed_order", "1",
       "observed order p = ln((f_1 - f_2) / (f_2 - f_3)) / ln r of this level (f_3) and the two coarser levels, with "
       "the refinement ratio r; empty for the two coarsest levels, and if the two differences have opposite signs or "
       "one of them is only rounding",
       &Row::order},
      {"order", "1", "observed_order", order, only_printed()},
      {"error_estimate", "unit of the metric",
       "estimated error of this level's result f. With an order: 1.25 |f - f*| (f* is the extrapolated value). Without "
       "an order: the larger of the range of the last three levels and the largest difference from a finer level. For "
       "an extreme or a metric that depends on contact events, the sampling spread is added (how much the result "
       "depends on the choice of the evaluated steps). For such a metric, the error with an order is at least the "
       "range of the last three levels, and without an order the difference of the two finest levels is also added "
       "(divided by r - 1 if the ratio r of the levels is smaller than 2)",
       &Row::error},
      {"error %", "1", "of converge: error_estimate divided by the result of the finest level", percent,
       only_printed()},
      {"seconds", "s", "of converge: processor time of the level's run [s]", &Row::seconds,
       under("run s", 2, kOnlyJson)}};
}

/// Returns the columns of the times. They have a separate file, because the other files are identical if the command
/// is repeated.
Columns<LevelRow> time_columns() {
  return {{"value", "unit of the field", "value of the refined field at this level", &LevelRow::value},
          {"seconds", "s", "processor time of the level's run", &LevelRow::seconds}};
}

Columns<ConvergeStudy> order_columns() {
  using Row = ConvergeStudy;
  const auto low = [](const Row& r) { return r.band ? Cell(r.band->first) : Cell(); };
  const auto high = [](const Row& r) { return r.band ? Cell(r.band->second) : Cell(); };
  return {
      {"metric", "", "name of the metric", &Row::metric},
      {"field", "", "path of the refined field", &Row::field},
      {"formal_order", "1",
       "formal order, expected from theory. For time.step_s with a device: 1, because the device holds the force "
       "between samples. For time.step_s without a device: order of the integrator (for leapfrog without damping 2, "
       "the order of amplitudes; positions at a fixed time have order 1). For other fields: 2",
       &Row::formal_order},
      {"observed_order", "1",
       "observed order of the three finest levels; empty if no order is credible (column reason)", &Row::order,
       kOnlyCsv},
      {"order", "1", "observed order of the three finest levels; null if no order is credible (field reason)",
       &Row::order, kOnlyJson},
      {"reason", "", "reason why no order is stated; empty if there is an order", &Row::reason},
      {"extrapolated", "unit of the metric",
       "extrapolated value (Richardson) f* = f_3 + (f_3 - f_2) / (r^p - 1), with the results f_3 of the finest and f_2 "
       "of the second finest level; empty without an order",
       &Row::extrapolated},
      {"gci", "1",
       "grid convergence index of the finest level, 1.25 |f_3 - f_2| / (|f_3| (r^p - 1)): relative error with a "
       "factor of safety; empty without an order",
       &Row::gci},
      {"asymptotic", "",
       "true if the order is asymptotic: GCI_21 / (r^p GCI_32) is within 0.1 of 1 for the three finest levels (level 3 "
       "is the finest) and, with four levels or more, also for the three levels that end at the second finest",
       &Row::asymptotic},
      {"low", "unit of the metric",
       "smallest result of the band (the last three levels that have the outcome of the finest level), for an extreme "
       "or a metric that depends on contact events minus the sampling spread (column error_estimate)",
       low, kOnlyCsv},
      {"high", "unit of the metric",
       "largest result of the band (column low), for an extreme or a metric that depends on contact events plus the "
       "sampling spread",
       high, kOnlyCsv}};
}

Json study_json(const ConvergeStudy& study) {
  Json json = order_columns().json(study);
  json["band"] = study.band ? Json::array({study.band->first, study.band->second}) : Json(nullptr);
  json["levels"] = level_columns(study).json_list(study.levels);
  return json;
}

/// Returns a sentence on how reliable an observed order is.
std::string order_text(const ConvergeStudy& study) {
  const auto is_known = [](const auto& error) { return error.has_value(); };
  if (std::ranges::count_if(study.errors, is_known) == 3) return "from three levels only";
  return study.asymptotic ? "asymptotic" : "not yet asymptotic";
}

std::string verdict_text(const ConvergeStudy& study) {
  if (study.order) {
    const std::string gci = study.gci ? fmt::format(", GCI {:.2g} %", 100.0 * *study.gci) : "";
    return fmt::format("order {:.2f} ({}): extrapolated value {}{}", *study.order, order_text(study),
                       with_error_text(*study.extrapolated, study.errors.back()), gci);
  }
  if (!study.band) return fmt::format("no order: {}", study.reason);
  const auto [low, high] = *study.band;
  if (low == high) return fmt::format("no order: {}; the last levels give {}", study.reason, significant(low, 6));
  // If the metric is an extreme value, its band (Convergence::band) is wider than the range of the levels' results,
  // because the extreme lies between two time steps.
  const bool has_spread = std::ranges::none_of(
      study.levels, [low = low](const LevelRow& level) { return level.result && *level.result <= low; });
  return fmt::format("no order: {}; the last levels{} give {} ... {}", study.reason,
                     has_spread ? " and their sampling spread" : "", number_text(low, high - low),
                     number_text(high, high - low));
}

/// Returns a sentence that names the coarsest level from which on all levels have relative errors below `max_error`,
/// and the cost of this level. If the error of the finest level is not below `max_error`, names the value of the field
/// at which an extrapolation reaches `max_error`. If the order is not asymptotic, says that no value is known. The same
/// if the levels differ in their noise (LevelSweep::has_noise).
std::string sufficient_level_text(const ConvergeStudy& study, bool has_noise, double max_error) {
  // Find the first level from which on all errors are below the bound.
  const std::vector<LevelRow>& levels = study.levels;
  std::size_t first = levels.size();
  while (first > 0 && levels[first - 1].share && *levels[first - 1].share < max_error) --first;
  const std::string below = fmt::format("error below {:g} %: ", 100.0 * max_error);
  if (has_noise) return below + "not known, because the levels differ in their noise";
  if (first < levels.size()) {
    const LevelRow& sufficient = levels[first];
    const std::string cost = fmt::format(", {:.2g} s per run, {:.2g} times the time of the first level",
                                         sufficient.seconds, sufficient.seconds / levels.front().seconds);
    return below + fmt::format("{} = {} ({:.2g} %{}){}", study.field, rounded_text(*finite_number(sufficient.value), 6),
                               100.0 * *sufficient.share,
                               study.order ? "" : ", estimated from the differences of the levels",
                               first == 0 ? ", already at the coarsest level" : cost);
  }
  // Otherwise extrapolate the required value of the field by the observed order.
  const LevelRow& finest = levels.back();
  if (!study.asymptotic || !finest.share) return below + "not known for any level";
  const double finer = math::pow(*finest.share / max_error, 1.0 / *study.order);
  return below + fmt::format("not reached by any level; extrapolated: {} = {:.2g}", study.field,
                             *finite_number(finest.value) / finer);
}

/// Converts the value of --to, such as "1%" or "0.01", to a relative error. Throws InputError unless the error lies
/// between 0 and 1.
double parse_relative_error(const std::string& text) {
  const bool percent = text.ends_with('%');
  const auto number = finite_number(std::string_view(text).substr(0, text.size() - (percent ? 1 : 0)));
  const double share = number.value_or(0.0) * (percent ? 0.01 : 1.0);
  if (!(share > 0.0 && share < 1.0))
    fail_in_option("--to", fmt::format("got \"{}\"; allowed: a relative error, such as 1% or 0.01", text));
  return share;
}

/// Runs a scene and measures the processor time of the run, without the preparation of its point shell and of the
/// search grid of the shell.
LevelRun run_of(const CheckedScenario& scene) {
  const auto shell = make_shell(scene.scenario(), scene.files());
  [[maybe_unused]] const BareRun prepared(scene, shell);  // the first search in a shell builds its grid
  const double before = processor_seconds();
  Result result = run_with_shell(scene, shell);
  return {std::move(result), processor_seconds() - before};
}

/// Returns the levels for refining the field. Throws InputError if the scene has no such numeric field.
LevelSweep levels_of(const ConvergeOptions& options, const ScenarioText& scenario) {
  // Ignore the warnings about this scenario here, because plan_sweep() returns them.
  const CheckedScenario scene = checked(load_scenario(scenario, options.overrides));
  const LoadedScenario& loaded = scene.loaded();
  if (current_value(loaded.scenario, options.field).is_null()) {
    std::vector<std::string> given = options.overrides;
    given.push_back(options.field + "=1");
    load_scenario(scenario, given);  // throws if the field does not exist or takes no number
  }
  return with_file(loaded, [&] {
    return level_sweep(loaded, options.field,
                       static_cast<std::size_t>(options.levels > 0 ? options.levels : kLevelsOfMetrics), options.ratio);
  });
}

/// Returns the requested position error of a work-precision study [m]: the value of --to, or its default.
double parse_position_error(const std::string& text) {
  if (text.empty()) return kRequestedError;
  const auto number = finite_number(text);
  if (!number || *number <= 0.0 || *number > kMaxRequestedError)
    fail_in_option("--to",
                   fmt::format("got \"{}\"; allowed with --over: an error of the tip's position in metres, such "
                               "as 1e-6, at most {}",
                               text, kMaxRequestedError));
  return *number;
}

/// Runs a work-precision study: `converge --over`.
int study_settings(const ConvergeOptions& options, ProgramContext& context) {
  if (options.field != kStepPath)
    fail_in_option("--vary", fmt::format("got {}; allowed with --over: {}", options.field, kStepPath));
  if (!options.metrics.empty())
    fail_in_option("--metric", "cannot be combined with --over, which states the error of the tip's position");
  const double max_error = parse_position_error(options.to);
  const std::filesystem::path file = find_scenario(options.scenario);
  WorkPrecisionQuestion question{read_scenario_text(file), options.overrides};
  for (const std::string& axis : options.over) question.over.push_back(parse_axis(axis, false, "--over"));
  question.levels = static_cast<std::size_t>(options.levels > 0 ? options.levels : kLevelsOfSettings);
  question.ratio = options.ratio;
  question.max_error = max_error;
  // In a scene with a reference force, laws are compared with this force.
  const LoadedScenario loaded = load_scenario(question.scenario, options.overrides);
  if (loaded.scenario.reference_force) {
    if (std::ranges::count(question.over, "integrator.type", &Axis::path) > 0)
      fail_in_option("--over",
                     "got integrator.type for a scene with a reference_force, in which laws are compared with this "
                     "force; allowed: rendering.algorithm and other fields of rendering");
    const Cases cases({question.scenario}, options.overrides, question.over);
    Report report(options, "converge", "converge_" + file.stem().string(), context);
    report_model_errors(cases, job_options(options, "converge", context), context.layout(), report);
    report.add_text(fmt::format("\nresults in {}\n\"hapbench plot {}\" draws them\n", report.folder().string(),
                                shell_file(report.folder())));
    return report.finish();
  }
  Report report(options, "converge", "converge_" + file.stem().string(), context);
  const auto problems = work_precision(question, job_options(options, "converge", context));
  report.json() = Json::array();
  report_work_precision(problems, max_error, context.layout(), report);
  report.add_text(fmt::format("results in {}\n\"hapbench plot {}\" draws them\n", report.folder().string(),
                              shell_file(report.folder())));
  return report.finish();
}

int converge(const ConvergeOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  // Check all input before anything runs or is written.
  if (!(options.ratio > 1.0 && options.ratio <= kLargestRatio))
    fail_in_option("--ratio", fmt::format("got {}; allowed: more than 1, at most {}", options.ratio, kLargestRatio));
  if (!options.over.empty()) return study_settings(options, context);
  const auto max_error = options.to.empty() ? std::nullopt : std::optional(parse_relative_error(options.to));
  const std::filesystem::path file = find_scenario(options.scenario);
  const ScenarioText scenario = read_scenario_text(file);
  const LevelSweep levels = levels_of(options, scenario);
  const JobOptions jobs = job_options(options, "converge", context);
  const SweepPlan plan = plan_sweep(Cases({scenario}, options.overrides, {levels.axis}), jobs);
  std::vector<std::string> metrics = options.metrics;
  if (metrics.empty()) metrics = {chosen_metric(plan.metrics, "")};
  require_names("--metric", metrics, plan.metrics, "hapbench describe metrics");
  print_warnings(context, plan.warnings);
  Report report(options, "converge", "converge_" + file.stem().string(), context);
  // Run all levels.
  std::vector<LevelRun> runs(plan.cases.size());
  for_each_job(runs.size(), jobs, [&](std::size_t i) { runs[i] = run_of(checked(plan.cases.load(i))); });
  report.add_text(fmt::format("{}: {} refined from {} by a factor of {:g} per level, formal order {:g}\n\n",
                              runs.front().result.name, levels.axis.path, level_text(levels, 0), levels.ratio,
                              levels.formal_order));
  std::vector<ConvergeStudy> studies;
  std::vector<LevelRow> rows;
  for (const std::string& metric : metrics) {
    const ConvergeStudy& study = studies.emplace_back(convergence_study(levels, runs, metric));
    rows.insert(rows.end(), study.levels.begin(), study.levels.end());
    report.show(level_columns(study).table(study.levels, fmt::format("convergence of {}", metric), layout.in_full()));
    report.add_text("\n" + layout.wrapped(verdict_text(study), 0));
    if (max_error) report.add_text(layout.wrapped(sufficient_level_text(study, levels.has_noise, *max_error), 0));
    report.add_text("\n");
    report.json().push_back(study_json(study));
  }
  if (studies.size() == 1) report.json() = Json(report.json().front());
  report.write(kOrders, order_columns(), studies);
  report.write(kLevels, level_columns({}), rows);
  report.write(kTimes, time_columns(), studies.front().levels);
  report.add_text(layout.wrapped(
      "error %: estimated error (\"hapbench describe error_estimate\"), divided by the result of the finest level", 0));
  report.add_text(fmt::format("results in {}\n\"hapbench plot {}\" draws them\n", report.folder().string(),
                              shell_file(report.folder())));
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> converge_tables() {
  std::vector<DescribedTable> tables = {
      order_columns().described(kOrders, "written by converge: one line per metric"),
      level_columns({}).described(kLevels, "written by converge: one line per metric and level"),
      time_columns().described(
          kTimes,
          "written by converge: processor times, one line per level (in a file of their own because they differ from "
          "run to run)")};
  for (DescribedTable& table : work_precision_tables()) tables.push_back(std::move(table));
  return tables;
}

void add_converge(CommandLine& line) {
  auto [command, options] =
      line.command("converge", "Estimate the error of metrics by refining the time step or another field.", converge,
                   "no table is written");
  command.add("scenario <scenario>", options.scenario, "scenario file or name of a bundled scenario",
              {.required = true});
  command.add("--metric <name,...>", options.metrics,
              fmt::format("metrics of summary.json (default: {})", kDefaultMetrics[0]), {.comma_separated = true});
  command.add(
      "--vary <field>", options.field,
      "field to refine (default: time.step_s), such as environment.spacing_m (distance of surface points), "
      "environment.grid_m or tool.grid_m; or any other field with a real number above 0, if a smaller value reduces "
      "the error");
  command.add("--over <field=values>", options.over,
              "print run time and error for each value of these fields, such as integrator.type=all or "
              "rendering.algorithm=mean,proxy, at each level of the time step; repeatable",
              {.several = true});
  command.add("--levels <n>", options.levels,
              "number of levels, from the scenario's own value to finer values (default: 5; with --over: 4)",
              {.range = {{3, 9}}});
  command.add("--ratio <number>", options.ratio,
              "ratio of the field between two levels (default: 2); an integer for the time step");
  command.add(
      "--to <error>", options.to,
      "without --over: also print the coarsest level with a relative error below this (1% or 0.01) and its run time; "
      "with --over: print the cheapest setting whose error of the tip's position is below this [m] (default: 1e-6)");
  add_common(command, options, "converge_NAME");
  add_table(command, options.output);
  command.footer(
      "Result: one row per level with its error; the first row is your scenario's own setting. Below: the observed "
      "order, the extrapolated value and the relative error of the finest level (the grid convergence index of "
      "Roache).\n\n"
      "No order: if the contacts differ between levels or the differences do not shrink regularly, the text names the "
      "reason. Take the range of the finest levels as the answer, printed as \"the last levels ... give A ... B\".\n\n"
      "Files: converge.csv (one row per metric: order, extrapolated value, range), converge_levels.csv (one row per "
      "metric and level: value, error_estimate), converge_levels_timing.csv (run times). They replace earlier "
      "files.\n\n"
      "Run time against error: --over compares each setting with a converged solution, computed by rk4 with a time "
      "step at least 16 times smaller. Errors are rms differences of the tip's position and of the force over the run. "
      "Each law has its own converged solution. No error is stated if each time step has another noise, or if the "
      "trajectory cannot be predicted; of several trials, the first runs. Files: convergence.csv (errors) and "
      "convergence_timing.csv.\n\n"
      "Reference force: in a scene with a reference_force (hapbench new fidelity), --over compares the laws with this "
      "force instead: direction and size of the error, and median and 99.9th percentile of the time of a step. Files: "
      "convergence_model.csv and convergence_model_timing.csv.\n\n"
      "Time: all default levels of the time step together take about 31 times as long as one run.");
}

}  // namespace hapbench
