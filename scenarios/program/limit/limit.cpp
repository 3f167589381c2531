#include "scenarios/program/limit/limit.hpp"

#include <fmt/format.h>

#include "scenarios/program/limit/columns.hpp"
#include "scenarios/program/limit/question.hpp"
#include "scenarios/program/limit/text.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/vibration_limit.hpp"

namespace hapbench {
namespace {

/// Searches the limits. A single search uses all threads for its runs; several searches run in parallel with
/// one thread each.
void find_limits(const LimitOptions& options, std::vector<LimitRow>& rows, const ProgramContext& context) {
  const bool alone = rows.size() == 1;
  if (alone) rows[0].asked.threads = threads_of(options);
  const WaitNotice notice("limit", !options.output.quiet && alone);
  for_each_job(rows.size(), job_options(options, alone ? "" : "limit", context),
               [&](std::size_t i) { rows[i].limit = field_limit(rows[i].asked); });
}

/// Computes the ratios of each limit to the limit of the first case in its block of rows.
void add_ratios(LimitTable& table) {
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    LimitRow& row = table.rows[i];
    const FieldLimit& reference = table.rows[i - i % table.columns()].limit;
    if (!row.limit.end.value || !reference.end.value) continue;
    row.stiffness_ratio = *row.limit.end.value / *reference.end.value;
    if (const double lambda = reference.settled.lambda_max; lambda > 0.0)
      row.rendered_ratio = *row.stiffness_ratio * row.limit.settled.lambda_max / lambda;
  }
}

/// Reports the limits in the CSV files, the printed text and the JSON.
void tell_limits(const LimitTable& table, const Layout& layout, Report& report) {
  const LimitQuestion& question = table.first().asked;
  const Columns<LimitRow> columns = limit_columns(&table);
  // Collect the runs of all cases, and the limits as JSON.
  std::vector<LimitRunRow> runs;
  Json limits = Json::array();
  for (const LimitRow& row : table.rows) {
    Json inconsistent = Json::array();
    for (const JudgedValue& run : row.limit.inconsistent)
      inconsistent.push_back({{"value", run.value}, {"class", run_verdict_name(run.verdict)}});
    Json& limit = limits.emplace_back(columns.json(row));
    limit[kInconsistent] = limit[kAstray] = inconsistent;
    for (const JudgedValue& run : row.limit.runs) runs.push_back({row, run});
  }
  report.write("limit.csv", columns, table.rows);
  report.write("limit_runs.csv", limit_run_columns(&table), runs);
  report.say(limits_text(table, columns, layout));
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
  LimitTable table = asked_table(options);
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < table.cases.size(); ++i) table.rows.push_back(asked_row(options, table, i, warnings));
  print_warnings(context, warnings);
  Report report(options, options.scenarios.size() > 1 ? "limit" : "limit_" + table.first().scene(), context);
  find_limits(options, table.rows, context);
  add_ratios(table);
  tell_limits(table, layout, report);
  report.say(fmt::format("\nresults in {}\n", report.folder().string()));
  return report.finish();
}

}  // namespace

void add_limit(CommandLine& line) {
  auto [command, options] = line.command(
      "limit", "Find how far any field may go, on which device, with which algorithm, by bisection on runs", limit,
      "no limit is written");
  command.add("scenarios", options.scenarios, "scenario files, or names of bundled scenarios", {.required = true});
  command.add("--vary", options.field, fmt::format("the field (default: {})", options.field));
  command.add("--between", options.between,
              "a:b, the range to search (default: a thousandth to a thousandfold of the scenario's value)");
  command.flag("--smallest", options.smallest, "find the smallest stable value instead, as of a mass");
  add_algorithms(command, options.algorithms, "each scenario's own");
  command.add("--device", options.devices,
              "in place of each scene's own: presets, ideal, admittance, files NAME.json, all, or impedance for all "
              "presets, separated by commas; a preset also at both ends of what nobody published of it",
              {.comma_separated = true});
  command.add("--friction", options.friction,
              "in place of these ends each device's dry friction times factors, such as 0,2; none: neither",
              {.comma_separated = true});
  command.add("--over", options.over,
              "ask for each value of another field, which it takes as sweep --vary does; repeatable",
              {.several = true});
  command.add(
      "--stable", options.stable,
      "what a run has to do: be settled (come to rest), bounded (vibrating also counts) or still (a handle that "
      "does not vibrate; default where a script moves the tool, elsewhere settled)",
      {.one_of = {"settled", "bounded", "still"}});
  command.add(
      "--vibration", options.vibration,
      fmt::format("of still: the largest vibration of the handle above 30 Hz [m/s rms] (default: {})", kMostVibration));
  command.add("--bound", options.bounds,
              "a stable run also keeps metric=most or metric=least:most, as inside_settled_m=3e-4; repeatable");
  command.add("--resolution", options.resolution,
              "relative width of the answer (default: 0.001); of the range when the range reaches 0 or below");
  add_common(command, options, "limit_NAME");
  command.footer(
      "A run is stable when it comes to rest or dies out; where a script moves the tool, when its handle does not "
      "vibrate. \"hapbench describe stability\" has all classes. Oscillations slower than a quarter of the run are "
      "not seen. The range is tried at 17 values. The first edge upwards of the scenario's own value (of the first "
      "stable value, if that one is not stable; with --smallest downwards, from the high end) is bisected, then the "
      "other end of the interval of stable values, below which a surface may be too soft; three values are tried on "
      "either side of the first edge, which may reveal an earlier edge. Of one scene and device the interval is then "
      "tried at 48 values between its ends and 8 just below its edge, and ends at the first that is not stable; "
      "where no 2 % of values are stable, there is no edge. The linear edge, of the loop in contact, is the answer "
      "where stable runs beyond it are intermittent contact. The column inconsistent counts unstable values in the "
      "interval and stable ones outside of it. Where the hand is an impedance, a run without environment tells "
      "whether hand and device alone are unstable beyond the edge. A hand with a mass loses it on ideal and "
      "admittance, where the virtual mass stands for it. limit_runs.csv has every run.");
}

}  // namespace hapbench
