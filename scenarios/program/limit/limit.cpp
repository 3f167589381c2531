#include "scenarios/program/limit/limit.hpp"

#include <fmt/format.h>

#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/program/limit/columns.hpp"
#include "scenarios/program/limit/question.hpp"
#include "scenarios/program/limit/text.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/vibration_limit.hpp"

namespace hapbench {
namespace {

/// Searches the limit of each row. A single search uses all threads for its runs; several searches run in parallel with
/// one thread each.
void find_limits(const LimitOptions& options, std::vector<LimitRow>& rows, const ProgramContext& context) {
  const bool alone = rows.size() == 1;
  if (alone) rows[0].question.threads = threads_of(options);
  const WaitNotice notice("limit", !options.output.quiet && alone);
  for_each_job(rows.size(), job_options(options, alone ? "" : "limit", context),
               [&](std::size_t i) { rows[i].limit = field_limit(rows[i].question); });
}

/// Computes the ratios of each limit to the limit of its reference case (LimitRow::stiffness_ratio). Each block of
/// table.columns() rows begins with the reference case of all its rows.
void add_ratios(LimitTable& table) {
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    LimitRow& row = table.rows[i];
    const FieldLimit& reference = table.rows[i - i % table.columns()].limit;
    if (!row.limit.end.tolerance() || !reference.end.tolerance()) continue;  // the end of the range is no limit
    row.stiffness_ratio = *row.limit.end.value / *reference.end.value;
    if (const double lambda = reference.settled.lambda_max; lambda > 0.0)
      row.rendered_ratio = *row.stiffness_ratio * row.limit.settled.lambda_max / lambda;
  }
}

/// Reports the limits in the CSV files, the printed text and the JSON.
void report_limits(const LimitTable& table, const Layout& layout, Report& report) {
  const LimitQuestion& question = table.first().question;
  const Columns<LimitRow> columns = limit_columns(&table);
  // Collect the runs of all cases, and the limits as JSON.
  std::vector<LimitRunRow> runs;
  Json limits = Json::array();
  for (const LimitRow& row : table.rows) {
    Json inconsistent = Json::array();
    for (const JudgedValue& run : row.limit.inconsistent)
      inconsistent.push_back({{"value", run.value}, {"class", run_verdict_name(run.verdict)}});
    Json& limit = limits.emplace_back(columns.json(row));
    limit[kNonMonotonic] = std::move(inconsistent);
    for (const JudgedValue& run : row.limit.runs) runs.push_back({row, run});
  }
  report.write("limit.csv", columns, table.rows);
  report.write("limit_runs.csv", limit_run_columns(&table), runs);
  report_limits_text(table, columns, layout, report);
  report.json() = {{"field", question.path},
                   {"side", question.side()},
                   {"from", question.search.range.from},
                   {"to", question.search.range.to},
                   {"resolution", question.search.resolution},
                   {"rule", rule_text(question.rule, table.first().scenario)},
                   {"limits", std::move(limits)}};
}

int limit(const LimitOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  LimitTable table = make_limit_table(options);
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < table.cases.size(); ++i)
    table.rows.push_back(make_limit_row(options, table, i, warnings));
  print_warnings(context, warnings);
  Report report(options, "limit", options.scenarios.size() > 1 ? "limit" : "limit_" + table.first().scene(), context);
  find_limits(options, table.rows, context);
  add_ratios(table);
  report_limits(table, layout, report);
  report.add_text(fmt::format("\nresults in {}\n", report.folder().string()));
  return report.finish();
}

}  // namespace

void add_limit(CommandLine& line) {
  auto [command, options] = line.command(
      "limit", "Find the largest (or smallest) value of a field at which the runs of a scenario are stable.", limit,
      "no limit is written");
  command.add("scenarios <scenario>...", options.scenarios,
              "scenario files, names of bundled scenarios, or the name of a study (\"hapbench describe studies\")",
              {.required = true});
  command.add("--vary <field>", options.field, fmt::format("field to search (default: {})", options.field));
  command.add("--between <a:b>", options.between,
              "range to search, in the unit of the field (default: 0.001 to 1000 times the current value)");
  command.flag("--smallest", options.smallest, "find the smallest stable value instead, for example of a mass");
  add_algorithms(command, options.algorithms, "the scenario's algorithm");
  command.add(
      "--device <name,...>", options.devices,
      "devices instead of the scenario's: presets (hapbench describe presets), ideal, admittance, files NAME.json, "
      "all, or impedance for all presets; presets also run with all their unpublished parameters at the soft and at "
      "the stiff end",
      {.comma_separated = true});
  command.add(
      "--friction <factor,...>", options.friction,
      "with --device: replaces the runs at the soft and stiff ends by runs with the dry friction times each factor, "
      "such as 0,2; none: only the device as it is",
      {.comma_separated = true});
  command.add("--over <field=values>", options.over,
              "repeat the search for each value of another field, written like sweep --vary, such as "
              "rendering.damping_N_s_per_m=1:100:5:log (Z-width); repeatable",
              {.several = true});
  command.add(
      "--stable <rule>", options.stable,
      "which runs are stable: settled (they come to rest or their oscillation decays), bounded (they may also vibrate) "
      "or still (the handle hardly vibrates); default: settled, or still if a script moves the tool",
      {.one_of = {"settled", "bounded", "still"}});
  command.add(
      "--vibration <m/s>", options.vibration,
      fmt::format("for the rule still: largest vibration of the handle, rms above 30 Hz (default: {})", kMaxVibration));
  command.add("--bound <metric=range>", options.bounds,
              "a stable run must also keep METRIC=MAX or METRIC=MIN:MAX, such as inside_settled_m=3e-4; repeatable");
  command.add(
      "--resolution <ratio>", options.resolution,
      "relative width of the interval that encloses the limit (default: 0.001); relative to the range if the range "
      "reaches 0 or below");
  add_common(command, options, "limit_NAME");
  add_table(command, options.output);
  command.footer(fmt::format(
      "Stable: the run comes to rest or its oscillation decays; if a script moves the tool, the handle hardly "
      "vibrates. A run that diverges, passes through the surface, loses contact, sticks or never touches is unstable. "
      "\"hapbench describe stability\" defines all classes.\n\n"
      "Result: the simulated limit, the linear limit, and which of the two to quote, with the reason. The simulated "
      "limit is found by bisection on runs. The linear limit follows from the eigenvalues of the loop of hand, device "
      "and contact.\n\n"
      "Limit to quote: the smaller of the two, or with --smallest the larger. There is none if no value is stable, or "
      "if all runs are stable and the range has no linear limit: then try a wider --between.\n\n"
      "Files: limit.csv has one row per search, limit_runs.csv one row per run with its class. They replace the files "
      "of an earlier search in the same folder.\n\n"
      "Time: 100 to 400 runs for one search; {} of them verify that other values on the stable side are stable too "
      "(verification samples). With --device or --over, a search skips these runs and needs only 30 to 50.\n\n"
      "Exit status: 0 also if no value or every value is stable; 2 bad input; 130 stopped by Ctrl-C.",
      kVerificationSamples + kSamplesNearLimit));
}

}  // namespace hapbench
