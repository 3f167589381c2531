#include "scenarios/program/converge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

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
#include "scenarios/program/digits.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
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

struct ConvergeOptions : CommonOptions {
  std::string scenario;
  std::vector<std::string> metrics;
  std::string field = kStepPath;
  int levels = 5;
  double ratio = 2.0;
  std::string to;
};

struct LevelRun {
  Result result;
  double seconds = 0.0;
};

struct LevelRow {
  std::string metric, value, outcome;
  std::optional<double> result, order, error;
  double seconds;
  std::optional<double> share = {};  ///< the error relative to the finest result, as the grid convergence index
};

struct ConvergeStudy : Convergence {
  std::string metric, field;
  double formal_order;
  std::vector<LevelRow> levels;
};

ConvergeStudy studied(const LevelSweep& levels, const std::vector<LevelRun>& runs, const std::string& metric) {
  std::vector<LevelResult> results;
  for (std::size_t i = 0; i < runs.size(); ++i) results.push_back(level_result(levels, i, runs[i].result, metric));
  ConvergeStudy study{convergence_of(levels, results), metric, levels.axis.path, levels.formal_order, {}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    LevelRow& row =
        study.levels.emplace_back(LevelRow{metric, levels.axis.values[i], results[i].outcome, results[i].result,
                                           study.orders[i], study.errors[i], runs[i].seconds});
    if (row.error && *results.back().result != 0.0) row.share = *row.error / std::abs(*results.back().result);
  }
  return study;
}

/// `study`: what is printed, whose field and metric stand above the columns.
Columns<LevelRow> level_columns(const ConvergeStudy& study) {
  using Row = LevelRow;
  const auto value = [](const Row& r) { return finite_number(r.value); };
  const auto result = [](const Row& r) { return r.result ? number_text(*r.result, r.error) : "-"; };
  const auto order = [has_order = study.order.has_value()](const Row& r) {
    return has_order && r.order ? fmt::format("{:.2f}", *r.order) : "-";
  };
  const auto percent = [](const Row& r) { return r.share ? significant(100.0 * *r.share, 2) : "-"; };
  return {{"metric", "", "name of the metric", &Row::metric, kOnlyCsv},
          {"value", "by field", "value of the field that is refined", value},
          {study.field, "1", "", &Row::value, only_printed()},
          {"outcome", "", "how the run ended", &Row::outcome, under("outcome")},
          {"result", "by name",
           "the metric, at the times of the coarsest rows; empty where the run has none or diverges", &Row::result},
          {study.metric, "1", "", result, only_printed()},
          {"observed_order", "1", "p = ln((f_1 - f_2) / (f_2 - f_3)) / ln r of this level and the two before, if any",
           &Row::order},
          {"order", "1", "observed_order", order, only_printed()},
          {"error_estimate", "by name",
           "with an order 1.25 |f - f*|, else the largest distance from a finer level or in the band", &Row::error},
          {"error %", "1", "of converge: error over the result of the finest level", percent, only_printed()},
          {"seconds", "s", "of converge: processor time of the level's run [s]", &Row::seconds,
           under("run s", 2, kOnlyJson)}};
}

/// Times in a file of their own: the others are the same bytes in every run.
Columns<LevelRow> time_columns() {
  return {{"value", "by field", "value of the field that is refined", &LevelRow::value},
          {"seconds", "s", "processor time of the run", &LevelRow::seconds}};
}

Columns<ConvergeStudy> order_columns() {
  using Row = ConvergeStudy;
  const auto low = [](const Row& r) { return r.band ? Cell(r.band->first) : Cell(); };
  const auto high = [](const Row& r) { return r.band ? Cell(r.band->second) : Cell(); };
  return {
      {"metric", "", "name of the metric", &Row::metric},
      {"field", "", "path of the field", &Row::field},
      {"formal_order", "1",
       "of the integrator; 1 with a device, which holds the force between samples; 2 of other fields",
       &Row::formal_order},
      {"observed_order", "1", "at the three finest levels; empty where none is credible", &Row::order, kOnlyCsv},
      {"order", "1", "the same", &Row::order, kOnlyJson},
      {"reason", "", "why no order is stated", &Row::reason},
      {"extrapolated", "by name", "Richardson's value f* = f_3 + (f_3 - f_2) / (r^p - 1); only with an order",
       &Row::extrapolated},
      {"gci", "1",
       "grid convergence index 1.25 |f_3 - f_2| / (|f_3| (r^p - 1)) of the finest level; only with an order",
       &Row::gci},
      {"asymptotic", "",
       "true when GCI_21 / (r^p GCI_32) is 1 within 0.1 at the last three levels and the three before",
       &Row::asymptotic},
      {"low", "by name", "least result of the band: of the last three levels that ended as the finest", low, kOnlyCsv},
      {"high", "by name", "the largest", high, kOnlyCsv}};
}

Json study_json(const ConvergeStudy& study) {
  Json json = order_columns().json(study);
  json["band"] = study.band ? Json::array({study.band->first, study.band->second}) : Json(nullptr);
  json["levels"] = level_columns(study).json_list(study.levels);
  return json;
}

/// How far an observed order can be believed.
std::string order_text(const ConvergeStudy& study) {
  const auto is_known = [](const auto& error) { return error.has_value(); };
  if (std::ranges::count_if(study.errors, is_known) == 3) return "of three levels alone";
  return study.asymptotic ? "asymptotic" : "not yet asymptotic";
}

std::string verdict_text(const ConvergeStudy& study) {
  if (study.order) {
    const std::string gci = study.gci ? fmt::format(", GCI {:.2g} %", 100.0 * *study.gci) : "";
    return fmt::format("order {:.2f}, {}: tends to {}{}", *study.order, order_text(study),
                       with_error_text(*study.extrapolated, study.errors.back()), gci);
  }
  if (!study.band) return fmt::format("no order: {}", study.reason);
  const auto [low, high] = *study.band;
  if (low == high) return fmt::format("no order: {}; last levels {}", study.reason, significant(low, 6));
  return fmt::format("no order: {}; last levels {} ... {}", study.reason, number_text(low, high - low),
                     number_text(high, high - low));
}

/// The coarsest level whose error and those of all finer ones are below, and what it costs.
std::string enough_text(const ConvergeStudy& study, double most) {
  const std::vector<LevelRow>& levels = study.levels;
  std::size_t first = levels.size();
  while (first > 0 && levels[first - 1].share && *levels[first - 1].share < most) --first;
  const std::string below = fmt::format("below {:g} %: ", 100.0 * most);
  if (first < levels.size()) {
    const LevelRow& enough = levels[first];
    const std::string cost = fmt::format(", {:.2g} s a run, {:.2g} times the first level's", enough.seconds,
                                         enough.seconds / levels.front().seconds);
    return below + fmt::format("{} = {} ({:.2g} %{}){}", study.field, enough.value, 100.0 * *enough.share,
                               study.order ? "" : " by what the levels show",
                               first == 0 ? ", the coarsest that was tried" : cost);
  }
  const LevelRow& finest = levels.back();
  if (!study.asymptotic || !finest.share) return below + "no level is known to be";
  const double finer = math::pow(*finest.share / most, 1.0 / *study.order);
  return below + fmt::format("no level is; by this order {} = {:.2g} would be", study.field,
                             *finite_number(finest.value) / finer);
}

double share_of(const std::string& text) {
  const bool percent = text.ends_with('%');
  const auto number = finite_number(std::string_view(text).substr(0, text.size() - (percent ? 1 : 0)));
  const double share = number.value_or(0.0) * (percent ? 0.01 : 1.0);
  if (!(share > 0.0 && share < 1.0))
    fail_in_option("--to", fmt::format("got \"{}\"; allowed: a relative error, as 1% or 0.01", text));
  return share;
}

/// The time that this thread had of its processor, which other processes share without lengthening it.
double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

LevelRun run_of(const CheckedScenario& scene) {
  const auto shell = make_shell(scene.scenario(), scene.files());
  const double before = processor_seconds();
  Result result = run_with_shell(scene, shell);
  return {std::move(result), processor_seconds() - before};
}

/// The levels of a scene's field. Throws InputError where it has none.
LevelSweep levels_of(const ConvergeOptions& options, const ScenarioText& scenario) {
  const CheckedScenario scene = checked(load_scenario(scenario, options.overrides));  // the plan tells its warnings
  const LoadedScenario& loaded = scene.loaded();
  if (current_value(loaded.scenario, options.field).is_null()) {
    std::vector<std::string> given = options.overrides;
    given.push_back(options.field + "=1");
    load_scenario(scenario, given);  // a field that does not exist, or takes no number, says so itself
  }
  return with_file(loaded, [&] {
    return level_sweep(loaded, options.field, static_cast<std::size_t>(options.levels), options.ratio);
  });
}

int converge(const ConvergeOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  // All input is checked before anything runs or is written.
  if (!(options.ratio > 1.0 && options.ratio <= kLargestRatio))
    fail_in_option("--ratio", fmt::format("got {}; allowed: more than 1, at most {}", options.ratio, kLargestRatio));
  const auto most = options.to.empty() ? std::nullopt : std::optional(share_of(options.to));
  const std::filesystem::path file = find_scenario(options.scenario);
  const ScenarioText scenario = read_scenario_text(file);
  const LevelSweep levels = levels_of(options, scenario);
  const JobOptions jobs = job_options(options, "converge", context);
  const SweepPlan plan = plan_sweep(Cases({scenario}, options.overrides, {levels.axis}), jobs);
  std::vector<std::string> metrics = options.metrics;
  if (metrics.empty()) metrics = {chosen_metric(plan.metrics, "")};
  require_names("--metric", metrics, plan.metrics, "hapbench describe metrics");
  print_warnings(context, plan.warnings);
  Report report(options, "converge_" + file.stem().string(), context);
  std::vector<LevelRun> runs(plan.cases.size());
  for_each_job(runs.size(), jobs, [&](std::size_t i) { runs[i] = run_of(checked(plan.cases.load(i))); });
  report.say(fmt::format("{}: {} from {} in ratios of {:g}, formal order {:g}\n\n", runs.front().result.name,
                         levels.axis.path, levels.axis.values.front(), levels.ratio, levels.formal_order));
  std::vector<ConvergeStudy> studies;
  std::vector<LevelRow> rows;
  for (const std::string& metric : metrics) {
    const ConvergeStudy& study = studies.emplace_back(studied(levels, runs, metric));
    rows.insert(rows.end(), study.levels.begin(), study.levels.end());
    report.say(level_columns(study).text(study.levels, layout) + "\n" + layout.wrapped(verdict_text(study), 0));
    if (most) report.say(layout.wrapped(enough_text(study, *most), 0));
    report.say("\n");
    report.json().push_back(study_json(study));
  }
  if (studies.size() == 1) report.json() = Json(report.json().front());
  report.write(kOrders, order_columns(), studies);
  report.write(kLevels, level_columns({}), rows);
  report.write(kTimes, time_columns(), studies.front().levels);
  report.say(fmt::format("results in {0}\n\"hapbench plot {0}\" draws them\n", report.folder().string()));
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> converge_tables() {
  return {order_columns().described(kOrders, "of converge: one line per metric"),
          level_columns({}).described(kLevels, "of converge: one line per metric and level"),
          time_columns().described(
              kTimes, "of converge: one line per level; all its other files are the same bytes in every run")};
}

void add_converge(CommandLine& line) {
  auto [command, options] =
      line.command("converge", "Estimate the error of metrics by refining the time step or another field.", converge,
                   "no table is written");
  command.add("scenario <scenario>", options.scenario, "scenario file or name of a bundled scenario",
              {.required = true});
  command.add("--metric <name,...>", options.metrics,
              fmt::format("metrics of summary.json (default: {})", kDefaultMetrics[0]), {.comma_separated = true});
  command.add("--vary <field>", options.field,
              "field to refine (default: time.step_s), such as environment.spacing_m (distance of surface points), "
              "environment.grid_m or tool.grid_m; any positive number whose error falls with it");
  command.add("--levels <n>", options.levels, "number of levels; the coarsest has the scenario's value (default: 5)",
              {.range = {{3, 9}}});
  command.add("--ratio <number>", options.ratio,
              "ratio of the field between two levels (default: 2); an integer for the time step");
  command.add("--to <error>", options.to,
              "also print the coarsest level with a relative error below this, such as 1%, and its run time");
  add_common(command, options, "converge_NAME");
  command.footer(
      "Result: one row per level with its error; the first row is your scenario's own setting. Below: observed order, "
      "extrapolated value, and grid convergence index (Roache), the relative error of the finest level.\n\n"
      "No order: if the contacts differ between levels or the differences do not shrink regularly, the text names the "
      "reason. Take the range of the finest levels as the answer, printed as \"last levels A ... B\".\n\n"
      "Files: converge.csv (one row per metric: order, extrapolated value, range), converge_levels.csv (one row per "
      "metric and level: value, error_estimate), converge_levels_timing.csv (run times). They replace earlier files."
      "\n\n"
      "Time: with the default levels of the time step, about 31 times one run.");
}

}  // namespace hapbench
