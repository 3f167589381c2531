#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "scenarios/batch/result_folders.hpp"
#include "scenarios/batch/run_difference.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/result_tables.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct DiffOptions {
  std::string a;
  std::string b;
  double tolerance = 0.0;
  OutputOptions output;
};

/// A value of a file, cut if it is long.
std::string cut_value(const std::string& text) {
  constexpr std::size_t kLongest = 24;
  if (text.empty()) return "-";
  return text.size() <= kLongest ? text : text.substr(0, kLongest - 3) + "...";
}

std::string shown_size(double value) {
  return std::isinf(value) ? "no number" : significant(value, 3);
}

Columns<NamedDifference> value_columns(const char* heading, const char* meaning) {
  Columns<NamedDifference> columns;
  columns.print(heading, "", meaning, &NamedDifference::name);
  columns.print("A", "1", "of diff: the value in the first folder, RUN_A; its line A names it",
                [](const NamedDifference& d) { return cut_value(d.values.a); });
  columns.print("B", "1", "of diff: the value in the second folder, RUN_B; its line B names it",
                [](const NamedDifference& d) { return cut_value(d.values.b); });
  return columns;
}

Columns<NamedDifference> field_columns() {
  return value_columns("field", "of diff: a field in which the scenarios differ");
}

Columns<NamedDifference> result_columns() {
  Columns<NamedDifference> columns = value_columns("result", "of diff: a metric, or another entry of summary.json");
  columns.print("relative", "1", "|A - B| over the larger of |A| and |B|",
                [](const NamedDifference& d) { return shown_size(d.values.relative); });
  return columns;
}

Columns<ColumnDifference> column_columns() {
  Columns<ColumnDifference> columns;
  columns.print("column", "", "of diff: a column of trajectory.csv or sweep.csv that differs",
                &ColumnDifference::column);
  columns.print("largest difference", "1", "largest |A - B| of the column",
                [](const ColumnDifference& d) { return shown_size(d.largest); });
  columns.print("in row", "1", "where the largest difference is, from 0", &ColumnDifference::row);
  columns.print("relative to the largest", "1", "the largest difference over the column's largest magnitude",
                [](const ColumnDifference& d) { return shown_size(d.relative); });
  return columns;
}

/// The differences of a run in one line.
struct RunRow {
  std::string path;
  RunDifference run;
};

Columns<RunRow> run_columns(double tolerance) {
  Columns<RunRow> columns;
  columns.print("run", "", "of diff: folder of a run, below A and B", &RunRow::path);
  columns.print("is", "", "equal, or differs by more than the tolerance",
                [tolerance](const RunRow& r) { return r.run.is_beyond(tolerance) ? "differs" : "equal"; });
  columns.print("fields", "1", "number of fields in which the scenarios differ, which do not count",
                [](const RunRow& r) { return r.run.fields.size(); });
  columns.print("results", "1", "number of metrics and other results that differ",
                [](const RunRow& r) { return r.run.metrics.size(); });
  columns.print("largest relative", "1", "largest relative difference of these", [](const RunRow& r) {
    double relative = 0.0;
    for (const NamedDifference& metric : r.run.metrics) relative = std::max(relative, metric.values.relative);
    return shown_size(relative);
  });
  columns.print("from row", "1", "first row of trajectory.csv that differs, from 0", [](const RunRow& r) {
    const auto& trajectory = r.run.trajectory;
    return trajectory && trajectory->first ? Cell(std::uint64_t{trajectory->first->row}) : Cell();
  });
  return columns;
}

std::string metrics_text(const RunDifference& run, double tolerance) {
  std::vector<NamedDifference> beyond;
  for (const NamedDifference& metric : run.metrics)
    if (!(tolerance > 0.0 && metric.values.relative <= tolerance)) beyond.push_back(metric);
  std::string text = beyond.empty() ? "" : result_columns().table(beyond).text();
  const std::size_t within = run.metrics.size() - beyond.size();
  if (within > 0) text += fmt::format("{} more within the tolerance\n", within);
  return text.empty() ? "" : text + "\n";
}

std::string columns_text(const char* name, const TableDifference& difference) {
  const std::string rows = difference.rows_a == difference.rows_b
                               ? fmt::format("{} rows", difference.rows_a)
                               : fmt::format("{} and {} rows", difference.rows_a, difference.rows_b);
  std::string columns;
  if (!difference.only_in_a.empty())
    columns += fmt::format("  columns of A alone: {}\n", fmt::join(difference.only_in_a, ", "));
  if (!difference.only_in_b.empty())
    columns += fmt::format("  columns of B alone: {}\n", fmt::join(difference.only_in_b, ", "));
  if (difference.reordered) columns += "  the columns are in another order\n";
  if (!difference.first) {
    const bool whole = difference.rows_a == difference.rows_b && columns.empty();
    return fmt::format("{}: {}, the same{}\n{}", name, rows, whole ? "" : " as far as both go", columns);
  }
  const FirstDifference& first = *difference.first;
  return fmt::format("{}: {}, first different in row {} (from 0), column {}: {} and {}\n{}\n{}", name, rows, first.row,
                     first.column, cut_value(first.a), cut_value(first.b), columns,
                     column_columns().table(difference.columns).text());
}

std::string run_text(const RunDifference& run, double tolerance) {
  std::string text = run.fields.empty() ? "" : field_columns().table(run.fields).text() + "\n";
  text += metrics_text(run, tolerance);
  if (!run.unshared.empty()) {
    text += fmt::format("in A (<) or B (>) alone:\n  {}\n", fmt::join(run.unshared, "\n  "));
  }
  text += run.state_hash_a == run.state_hash_b
              ? fmt::format("state hash: {} in both\n", run.state_hash_a)
              : fmt::format("state hash: {} and {}\n", run.state_hash_a, run.state_hash_b);
  if (run.trajectory) text += columns_text("trajectory.csv", *run.trajectory);
  if (run.trajectory_missing) text += "trajectory.csv: in one of them alone\n";
  return text;
}

/// A size; infinity, for which JSON has no number, becomes "no number" as in the text.
Json size_json(double value) {
  return std::isinf(value) ? Json("no number") : Json(value);
}

Json table_json(const TableDifference& difference) {
  Json columns = Json::object();
  for (const ColumnDifference& column : difference.columns) {
    columns[column.column] = {
        {"largest", size_json(column.largest)}, {"row", column.row}, {"relative", size_json(column.relative)}};
  }
  Json first = nullptr;
  if (difference.first) {
    first = {{"row", difference.first->row},
             {"column", difference.first->column},
             {"a", difference.first->a},
             {"b", difference.first->b}};
  }
  return {{"rows", {difference.rows_a, difference.rows_b}},
          {"first", std::move(first)},
          {"columns", std::move(columns)},
          {"only_in_a", difference.only_in_a},
          {"only_in_b", difference.only_in_b},
          {"reordered", difference.reordered}};
}

Json named_json(const std::vector<NamedDifference>& differences, bool sizes) {
  Json json = Json::object();
  for (const NamedDifference& d : differences) {
    json[d.name] = {{"a", d.values.a}, {"b", d.values.b}};
    if (sizes) json[d.name]["relative"] = size_json(d.values.relative);
  }
  return json;
}

Json run_json(const RunDifference& run) {
  return {{"fields", named_json(run.fields, false)},
          {"results", named_json(run.metrics, true)},
          {"unshared", run.unshared},
          {"state_hash", {run.state_hash_a, run.state_hash_b}},
          {"trajectory", run.trajectory           ? table_json(*run.trajectory)
                         : run.trajectory_missing ? Json("in one of them alone")
                                                  : Json(nullptr)}};
}

/// Collects the results while the pairs are compared one by one.
struct Differences {
  bool beyond = false;
  std::string text;
  Json runs = Json::object();
  Json sweeps = Json::object();
};

void compare_all_runs(const DiffOptions& options, const ResultPairs& pairs, Differences& report) {
  std::vector<RunRow> rows;
  for (const fs::path& path : pairs.runs) {
    const auto& [name, run] =
        rows.emplace_back(RunRow{path.empty() ? "." : path.generic_string(),
                                 compare_runs(fs::path(options.a) / path, fs::path(options.b) / path)});
    report.beyond |= run.is_beyond(options.tolerance);
    report.runs[name] = run_json(run);
  }
  report.text += rows.size() == 1 ? run_text(rows.front().run, options.tolerance)
                                  : run_columns(options.tolerance).table(rows).text();
}

void compare_all_sweeps(const DiffOptions& options, const ResultPairs& pairs, Differences& report) {
  for (const fs::path& path : pairs.sweeps) {
    const TableDifference table = compare_tables(fs::path(options.a) / path, fs::path(options.b) / path);
    report.beyond |= table.is_beyond(options.tolerance);
    report.text += "\n" + columns_text(path.c_str(), table);
    report.sweeps[path.generic_string()] = table_json(table);
  }
}

std::vector<std::string> texts_of(const std::vector<fs::path>& paths) {
  std::vector<std::string> texts;
  for (const fs::path& path : paths) texts.push_back(path.generic_string());
  return texts;
}

int diff(const DiffOptions& options) {
  if (!(options.tolerance >= 0.0 && std::isfinite(options.tolerance))) {
    throw InputError(fmt::format("--tolerance: got {}; allowed: a number >= 0", options.tolerance));
  }
  const ResultPairs pairs = pair_results(options.a, options.b);
  const std::vector<std::string> only_a = texts_of(pairs.only_in_a), only_b = texts_of(pairs.only_in_b);
  Differences report;
  report.beyond = !only_a.empty() || !only_b.empty();
  report.text = fmt::format("A {}\nB {}\n\n", options.a, options.b);
  compare_all_runs(options, pairs, report);
  compare_all_sweeps(options, pairs, report);
  if (!only_a.empty()) report.text += fmt::format("in A alone: {}\n", fmt::join(only_a, ", "));
  if (!only_b.empty()) report.text += fmt::format("in B alone: {}\n", fmt::join(only_b, ", "));
  const std::string tolerance =
      options.tolerance > 0.0 ? fmt::format(" within a relative tolerance of {}", options.tolerance) : "";
  report.text += fmt::format("\nthe results are {}equal{}\n", report.beyond ? "not " : "", tolerance);
  print(options.output, report.text,
        {{"equal", !report.beyond},
         {"tolerance", options.tolerance},
         {"runs", std::move(report.runs)},
         {"sweeps", std::move(report.sweeps)},
         {"only_in_a", only_a},
         {"only_in_b", only_b}});
  return report.beyond ? kUnexpectedOutcome : kSuccess;
}

}  // namespace

std::vector<DescribedTable> diff_tables() {
  return {field_columns().described(), result_columns().described(), column_columns().described(),
          run_columns(0.0).described()};
}

void add_diff(CommandLine& line) {
  auto [command, options] =
      line.command("diff", "Compare the results of two runs, or of two folders of runs: a regression test", diff);
  command.add("run_a", options.a, "folder of a run, or of run, compare or sweep with several").required();
  command.add("run_b", options.b, "another; runs are paired by their paths in the folders").required();
  command.add("--tolerance", options.tolerance,
              "largest relative difference that counts as equal: of a metric to the larger of the two, of a column of "
              "trajectory.csv to its largest magnitude (default: 0, the same digits)");
  add_output_options(command, options.output);
  command.footer(
      "For a regression test keep the results of a good version and compare every new one with them. Results are the "
      "outcome, the metrics and warnings of summary.json and trajectory.csv; without a tolerance the state hash, too. What "
      "one of them alone has, a metric, a warning or a column, makes them unequal whatever the tolerance. Fields of the "
      "scenario are shown where they differ but do not count; provenance, times and counted work are not looked at. Of "
      "a sweep whose runs were not kept, the rows of sweep.csv are compared.\n"
      "Exit status: 0 equal, 2 not the results of runs, 3 not equal.");
}

}  // namespace hapbench
