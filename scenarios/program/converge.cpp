#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "results/io/table_writer.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/sweep.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/studies/stability/field_limit.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr const char *kOrders = "converge.csv", *kLevels = "converge_levels.csv",
                     *kTimes = "converge_levels_timing.csv";
constexpr int kFewestLevels = 3, kMostLevels = 9;
constexpr double kLargestRatio = 10.0;

struct ConvergeOptions {
  std::string scenario;
  std::vector<std::string> metrics;
  std::string field = kStepPath;
  int levels = 5;
  double ratio = 2.0;
  std::string to;
  bool resume = false;
  unsigned jobs = 0;  ///< 0: one per thread of the machine
  std::string out;
  std::vector<std::string> overrides;
  OutputOptions output;
};

/// The levels of a field with what a metric came to at each, and the verdict.
struct ConvergeStudy {
  const LevelSweep& levels;
  const SweepTable& runs;
  std::span<const std::optional<double>> seconds;  ///< of each run; none for one that was done before
  std::string metric;
  std::vector<std::optional<double>> results;
  Convergence found;

  /// Relative to the finest result, as the grid convergence index.
  std::optional<double> relative_error(std::size_t level) const {
    if (!found.errors[level] || *results.back() == 0.0) return std::nullopt;
    return *found.errors[level] / std::abs(*results.back());
  }
};

// ---- Files and JSON

struct LevelRow {
  const ConvergeStudy& study;
  std::size_t level;
};
using LevelField = Field<LevelRow>;

const LevelField kLevelFields[] = {
    {{"metric", "", "name of the metric"},
     [](const LevelRow& r) -> Cell { return r.study.metric; },
     LevelField::In::csv},
    {{"value", "by field", "value of the field that is refined"},
     [](const LevelRow& r) { return cell_if(finite_number(r.study.levels.axis.values[r.level])); }},
    {{"outcome", "", "how the run ended"},
     [](const LevelRow& r) -> Cell { return r.study.runs.outcome(r.study.runs.rows[r.level]); }},
    {{"result", "by name", "the metric, at the times of the coarsest rows; empty where the run has none or diverges"},
     [](const LevelRow& r) { return cell_if(r.study.results[r.level]); }},
    {{"observed_order", "1", "p = ln((f_1 - f_2) / (f_2 - f_3)) / ln r of this level and the two before, if any"},
     [](const LevelRow& r) { return cell_if(r.study.found.orders[r.level]); }},
    {{"error_estimate", "by name",
      "with an order 1.25 |f - f*|, else the largest distance from a finer level or in the band"},
     [](const LevelRow& r) { return cell_if(r.study.found.errors[r.level]); }},
    {{"seconds", "s", "processor time of the run, of a short one the least of five; in converge_levels_timing.csv"},
     [](const LevelRow& r) { return cell_if(r.study.seconds[r.level]); },
     LevelField::In::json}};

using OrderField = Field<ConvergeStudy>;

const OrderField kOrderFields[] = {
    {{"metric", "", "name of the metric"}, [](const ConvergeStudy& s) -> Cell { return s.metric; }},
    {{"field", "", "path of the field"}, [](const ConvergeStudy& s) -> Cell { return s.levels.axis.path; }},
    {{"formal_order", "1",
      "of the integrator; 1 with a device, which holds the force between samples; 2 of other fields"},
     [](const ConvergeStudy& s) -> Cell { return s.levels.formal_order; }},
    {{"observed_order", "1", "at the three finest levels; empty where none is credible"},
     [](const ConvergeStudy& s) { return cell_if(s.found.order); },
     OrderField::In::csv},
    {{"order", "1", "the same"}, [](const ConvergeStudy& s) { return cell_if(s.found.order); }, OrderField::In::json},
    {{"reason", "", "why no order is stated"}, [](const ConvergeStudy& s) -> Cell { return s.found.reason; }},
    {{"extrapolated", "by name", "Richardson's value f* = f_3 + (f_3 - f_2) / (r^p - 1); only with an order"},
     [](const ConvergeStudy& s) { return cell_if(s.found.extrapolated); }},
    {{"gci", "1",
      "grid convergence index 1.25 |f_3 - f_2| / (|f_3| (r^p - 1)) of the finest level; only with an order"},
     [](const ConvergeStudy& s) { return cell_if(s.found.gci); }},
    {{"asymptotic", "",
      "true when GCI_21 / (r^p GCI_32) is 1 within 0.1 at the last three levels and the three before"},
     [](const ConvergeStudy& s) -> Cell { return s.found.asymptotic; }},
    {{"low", "by name", "least result of the band: of the last three levels that ended as the finest"},
     [](const ConvergeStudy& s) { return s.found.band ? Cell(s.found.band->first) : Cell(); },
     OrderField::In::csv},
    {{"high", "by name", "the largest"},
     [](const ConvergeStudy& s) { return s.found.band ? Cell(s.found.band->second) : Cell(); },
     OrderField::In::csv}};

std::vector<LevelRow> level_rows(const std::vector<ConvergeStudy>& studies) {
  std::vector<LevelRow> rows;
  for (const ConvergeStudy& study : studies)
    for (std::size_t i = 0; i < study.results.size(); ++i) rows.push_back({study, i});
  return rows;
}

/// Times in a file of their own: the others are the same bytes in every run.
void write_studies(const fs::path& directory, const std::vector<ConvergeStudy>& studies) {
  FileSet files;
  write_csv(directory / kOrders, kOrderFields, studies, &files);
  write_csv(directory / kLevels, kLevelFields, level_rows(studies), &files);
  std::string times = "value,seconds\n";
  for (std::size_t i = 0; const auto& seconds : studies.front().seconds)
    times +=
        fmt::format("{},{}\n", studies.front().levels.axis.values[i++], seconds ? fmt::format("{}", *seconds) : "");
  files.write(directory / kTimes, times);
  files.commit();
}

Json study_json(const ConvergeStudy& study) {
  Json json;
  add_row(json, kOrderFields, study);
  json["band"] = study.found.band ? Json::array({study.found.band->first, study.found.band->second}) : Json(nullptr);
  Json& levels = json["levels"] = Json::array();
  for (std::size_t i = 0; i < study.results.size(); ++i) add_row(levels.emplace_back(), kLevelFields, {study, i});
  return json;
}

// ---- Text

std::string verdict_text(const ConvergeStudy& study) {
  const Convergence& c = study.found;
  if (c.order) {
    const bool three = std::ranges::count_if(c.errors, [](const auto& e) { return e.has_value(); }) == 3;
    return fmt::format("order {:.2f}, {}: tends to {}{}", *c.order,
                       three          ? "of three levels alone"
                       : c.asymptotic ? "asymptotic"
                                      : "not yet asymptotic",
                       with_error_text(*c.extrapolated, c.errors.back()),
                       c.gci ? fmt::format(", GCI {:.2g} %", 100.0 * *c.gci) : "");
  }
  if (!c.band) return fmt::format("no order: {}", c.reason);
  const auto [low, high] = *c.band;
  return fmt::format("no order: {}; last levels {}", c.reason,
                     low == high
                         ? significant(low, 6)
                         : fmt::format("{} ... {}", number_text(low, high - low), number_text(high, high - low)));
}

/// The coarsest level whose error and those of all finer ones are below, and what it costs.
std::string enough_text(const ConvergeStudy& study, double most) {
  std::size_t first = study.results.size();
  while (first > 0 && study.relative_error(first - 1) && *study.relative_error(first - 1) < most) --first;
  const std::string below = fmt::format("below {:g} %: ", 100.0 * most), &path = study.levels.axis.path;
  if (first < study.results.size()) {
    const auto &seconds = study.seconds[first], &own = study.seconds.front();
    return below +
           fmt::format("{} = {} ({:.2g} %{}){}", path, study.levels.axis.values[first],
                       100.0 * *study.relative_error(first), study.found.order ? "" : " by what the levels show",
                       first == 0 ? ", the coarsest that was tried"
                       : seconds && own
                           ? fmt::format(", {:.2g} s a run, {:.2g} times the first level's", *seconds, *seconds / *own)
                           : "");
  }
  const auto error = study.relative_error(study.results.size() - 1);
  if (!study.found.asymptotic || !error) return below + "no level is known to be";
  const double finer = math::pow(*error / most, 1.0 / *study.found.order);
  return below + fmt::format("no level is; by this order {} = {:.2g} would be", path,
                             *finite_number(study.levels.axis.values.back()) / finer);
}

std::string study_text(const ConvergeStudy& study, std::optional<double> most) {
  const std::string& path = study.levels.axis.path;
  std::vector<Table::Column> columns = converge_headings();
  columns.insert(columns.begin(), {path});
  columns.insert(columns.begin() + 2, {study.metric});
  Table table(columns);
  for (std::size_t i = 0; i < study.results.size(); ++i) {
    const auto error = study.relative_error(i);
    const Convergence& c = study.found;
    table.add({study.levels.axis.values[i], study.runs.outcome(study.runs.rows[i]),
               study.results[i] ? number_text(*study.results[i], c.errors[i]) : "-",
               c.order && c.orders[i] ? fmt::format("{:.2f}", *c.orders[i]) : "-",
               error ? significant(100.0 * *error, 2) : "-", significant(study.seconds[i], 2)});
  }
  std::string text = table.text() + "\n" + wrapped(verdict_text(study), 0);
  if (most) text += wrapped(enough_text(study, *most), 0);
  return text + "\n";
}

// ---- Command

double share_of(const std::string& text) {
  const bool percent = text.ends_with('%');
  const auto number = finite_number(std::string_view(text).substr(0, text.size() - (percent ? 1 : 0)));
  const double share = number.value_or(0.0) * (percent ? 0.01 : 1.0);
  if (!(share > 0.0 && share < 1.0))
    throw InputError(fmt::format("--to: got \"{}\"; allowed: a relative error, as 1% or 0.01", text));
  return share;
}

int converge(const ConvergeOptions& options) {
  // All input is checked before anything runs or is written.
  if (!(options.ratio > 1.0 && options.ratio <= kLargestRatio))
    throw InputError(fmt::format("--ratio: got {}; allowed: more than 1, at most {}", options.ratio, kLargestRatio));
  const auto most = options.to.empty() ? std::nullopt : std::optional(share_of(options.to));
  const fs::path file = find_scenario(options.scenario);
  const ScenarioText scenario = read_scenario_text(file);
  const LoadedScenario loaded = load_scenario(scenario, options.overrides);
  check_named_files(loaded);  // the plan tells its warnings
  if (own_value(loaded.scenario, options.field).is_null()) {
    std::vector<std::string> given = options.overrides;
    given.push_back(options.field + "=1");
    load_scenario(scenario, given);  // a field that does not exist, or takes no number, says so itself
  }
  const LevelSweep levels = with_file(loaded, [&] {
    return level_sweep(loaded, options.field, static_cast<std::size_t>(options.levels), options.ratio);
  });
  SweepOptions sweep;
  sweep.directory = results_directory(options.out, "converge_" + file.stem().string());
  sweep.jobs = options.jobs == 0 ? available_threads() : options.jobs;
  sweep.resume = options.resume;
  sweep.progress = !options.output.quiet;
  const SweepPlan plan = plan_sweep(Cases({scenario}, options.overrides, {levels.axis}), sweep.jobs, sweep.progress);
  std::vector<std::string> metrics = options.metrics;
  if (metrics.empty()) metrics = {chosen_metric(plan.metrics, "")};
  require_names("--metric: got", metrics, plan.metrics);
  print_warnings(plan.warnings);
  require_writable_directory(sweep.directory);
  check_table_under_way(plan, sweep);
  // Those of another sweep must not stand beside this one if it is stopped.
  std::error_code ignored;
  for (const char* name : {kOrders, kLevels, kTimes}) fs::remove(sweep.directory / name, ignored);

  std::vector<std::optional<double>> seconds(plan.cases.size());
  sweep.timed = [&seconds](std::size_t run, double time) { seconds[run] = time; };
  const SweepReport report = run_sweep(plan, sweep);
  if (report.signal != 0) throw Stopped{report.signal};
  const SweepTable runs = read_sweep(table_of(sweep));
  std::vector<ConvergeStudy> studies;
  for (const std::string& metric : metrics) {
    studies.push_back({levels, runs, seconds, metric, {}, convergence_of(levels, runs, metric)});
    for (const SweepRow& row : runs.rows) studies.back().results.push_back(level_result(runs, row, metric));
  }
  write_studies(sweep.directory, studies);
  std::string text = fmt::format("{}: {} from {} in ratios of {:g}, formal order {:g}\n\n", loaded.scenario.name,
                                 levels.axis.path, levels.axis.values.front(), levels.ratio, levels.formal_order);
  Json json = Json::array();
  for (const ConvergeStudy& study : studies) {
    text += study_text(study, most);
    json.push_back(study_json(study));
  }
  const std::string where = sweep.directory.string();
  print(options.output, text + fmt::format("results in {0}\n\"hapbench plot {0}\" draws them\n", where),
        studies.size() == 1 ? json.front() : json);
  if (!report.failed) return kSuccess;
  print_error(fmt::format("{}: {} of {} runs failed, the first: {}", file.string(), runs.counts.failed,
                          runs.counts.runs, one_line(report.failed->problem)));
  return kInternalFault;
}

}  // namespace

std::vector<Column> converge_columns() {
  return columns_of(kOrderFields);
}

std::vector<Column> converge_level_columns() {
  std::vector<Column> columns = columns_of(kLevelFields);
  columns.push_back(std::end(kLevelFields)[-1].column);
  return columns;
}

std::vector<Table::Column> converge_headings() {
  return {{"outcome", false},
          {"order", true, "observed_order"},
          {"error %", true, "of converge: error over the result of the finest level"},
          {"run s", true,
           "of converge: processor time of the level's run [s]; of one under some milliseconds the least of five"}};
}

void add_converge(CommandLine& line) {
  auto [command, options] =
      line.command("converge", "Say how far metrics of a scene are from converged, in the step or any field", converge,
                   "the same command with --resume continues");
  command.add("scenario", options.scenario, "scenario file, or name of a bundled scenario").required();
  command
      .add("--metric", options.metrics,
           fmt::format("names of summary.json, separated by commas (default: {})", kDefaultMetrics[0]))
      .comma_separated();
  command.add(
      "--vary", options.field,
      "the field to refine: time.step_s (default), environment.grid_m, environment.spacing_m, tool.grid_m or any "
      "other number above 0 that gets better as it falls");
  command.add("--levels", options.levels, "number of levels, the scenario's own value the coarsest (default: 5)")
      .range(kFewestLevels, kMostLevels);
  command.add("--ratio", options.ratio, "of each level to the next; whole for the step (default: 2)");
  command.add("--to", options.to, "also name the coarsest level with a smaller relative error, as 1%, and its cost");
  add_jobs(command, options.jobs, "runs at once; only times depend on it (default: one per thread)");
  command.flag("--resume", options.resume, "continue an interrupted study of the same definition");
  command.add("--out", options.out, "directory of the results (default: results/out/converge_NAME)");
  add_overrides(command, options.overrides, "override a field of all levels: path=value");
  add_output_options(command, options.output);
  command.footer(
      "Observed order p, Richardson's value and grid convergence index of the three finest levels (Roache; ASME V&V 20; "
      "\"hapbench describe converge.csv\"). No order is stated, and the reason said, where contacts switch between them, "
      "where differences change their sign, grow or are rounding, where the order is more than twice the formal one, or "
      "where fewer than three levels end as the finest; the last levels are the answer then. Runs of shorter steps last as "
      "long, delays of devices keep their length, and metrics of motion, force and contact are taken at the times of the "
      "coarsest rows: a peak between these rows is not seen. Files: converge.csv, converge_levels.csv, sweep.csv.");
}

}  // namespace hapbench
