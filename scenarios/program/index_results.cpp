#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "results/record/recorder.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/studies/stability/judged_run.hpp"
#include "scenarios/thesis_claims/claims.hpp"

/// Names that results and printed tables have: metrics, files, columns, words, headings.
namespace hapbench {
namespace {

constexpr Column kShellColumns[] = {
    {"x_m", "m", "x of a point of the shell"},         {"y_m", "m", "y of a point of the shell"},
    {"z_m", "m", "z of a point of the shell"},         {"nx", "1", "x of the outward unit normal there"},
    {"ny", "1", "y of the outward unit normal there"}, {"nz", "1", "z of the outward unit normal there"}};

std::string titled(std::string_view name, std::string_view unit) {
  return unit.empty() ? std::string(name) : fmt::format("{} [{}]", name, unit);
}

/// Explains columns or metrics.
template <class Entries>
std::string entries_text(const Entries& entries) {
  std::string text;
  for (const auto& entry : entries) text += "  " + titled(entry.name, entry.unit) + "\n" + wrapped(entry.meaning, 6);
  return text;
}

Description describe_metrics() {
  const MetricList metrics = metrics_without_values();
  return {"metrics of summary.json, which expect.metrics may bound; f is f_render, the force on the tool\n\n" +
              entries_text(metrics),
          {{"kind", "metrics"}, {"metrics", columns_json(metrics)}}};
}

Description describe_metric(const Metric& metric) {
  return {fmt::format("metric {}\n{}", titled(metric.name, metric.unit), wrapped(metric.meaning)),
          {{"kind", "metric"}, {"name", metric.name}, {"unit", metric.unit}, {"meaning", metric.meaning}}};
}

Description describe_table(const DescribedTable& table) {
  Json columns = Json::array();
  for (const auto& [name, unit, meaning] : table.columns)
    columns.push_back({{"name", name}, {"unit", unit}, {"meaning", meaning}});
  return {fmt::format("file {}\n{}\n{}", table.file, wrapped(table.holds), entries_text(table.columns)),
          {{"kind", "file"}, {"name", table.file}, {"holds", table.holds}, {"columns", std::move(columns)}}};
}

Description describe_tables() {
  std::vector<Description> all;
  for (const DescribedTable& table : result_tables())
    if (!table.file.empty()) all.push_back(describe_table(table));
  return joined(all);
}

/// A column, and the files that have it with this meaning.
struct SharedColumn {
  DescribedTable::Entry column;
  std::vector<std::string> files;
};

Description describe_column(const SharedColumn& shared) {
  const auto& [name, unit, meaning] = shared.column;
  return {fmt::format("column {} of {}\n{}", titled(name, unit), fmt::join(shared.files, ", "), wrapped(meaning)),
          {{"kind", "column"}, {"name", name}, {"unit", unit}, {"meaning", meaning}, {"files", shared.files}}};
}

std::vector<SharedColumn> all_columns(const std::vector<DescribedTable>& tables) {
  std::vector<SharedColumn> all;
  for (const DescribedTable& table : tables) {
    if (table.file.empty()) continue;
    for (const DescribedTable::Entry& column : table.columns) {
      const auto same = std::ranges::find_if(all, [&column](const SharedColumn& known) {
        return known.column.name == column.name && known.column.meaning == column.meaning;
      });
      if (same != all.end()) {
        same->files.push_back(table.file);
      } else {
        all.push_back({column, {table.file}});
      }
    }
  }
  return all;
}

struct Word {
  std::string_view name;
  const char* kind;
  const char* meaning;
};

constexpr const char* kOutcome = "outcome of a run";
constexpr const char* kMotion = "class of motion, of limit and stability";
constexpr const char* kTime = "number of timing.json";
constexpr const char* kVerdict = "verdict on a claim";
constexpr const char* kResultFile = "file of the results";

/// Words that no enumeration has.
constexpr Word kWords[] = {
    {"step_p50_s", kTime, "what half of the steps take at most, each by itself, without observers and recorders [s]"},
    {"step_p99_s", kTime, "what 99 % of the steps take at most, each by itself, without observers and recorders [s]"},
    {"scenario.effective.json", kResultFile,
     "the scenario with every default filled in; run again it gives the same files"},
    {"timing.json", kResultFile,
     "of record.timing: wall times, percentiles, missed deadlines and histogram of single steps"},
    {"sweep.json", kResultFile,
     "what a sweep's table is a function of: scenario, overrides, points, named files, program"},
    {"sweep.csv.part", kResultFile,
     "rows of a sweep that is under way or was interrupted, from which --resume goes on"},
    {"sweep.I_of_N.csv", kResultFile,
     "rows of a shard of a sweep, which \"hapbench sweep FOLDER\" joins; columns as in sweep.csv"},
    {"hapbench_results.json", kResultFile, "what a comparison wrote into its folder, which the next one there removes"},
    {"report.html", kResultFile, "a page to read and replay, of report or scripts/reproduce"},
    {"plot.svg", kResultFile, "the picture of plot"},
    {"figures.json", kResultFile,
     "figures that scripts/figures drew, with their captions and the files they were drawn of"},
    {"claims.json", kResultFile, "the ledger of reproduce: claims, what was measured, verdicts, robustness"},
    {"claims.md", kResultFile, "the ledger of reproduce, for people"},
    {"choices.json", kResultFile, "what the thesis leaves open and what was chosen; \"describe choices_schema\""},
    {"choices.md", kResultFile, "the choices on record, for people"},
    {"robustness.csv", kResultFile, "of reproduce --choices: the choices and verdicts of each reading"},
    {"robustness.json", kResultFile,
     "how many samples have the verdict on record, and which choices decide it, for each claim"},
    {"quantum", "number of import",
     "the step in which the recorded places come along an axis, seen in their differences (its row resolution, quantum_m of "
     "--json); K times it is the step of force that the recording alone makes"}};

Description describe_word(const Word& word) {
  std::string text = fmt::format("{}: {}\n{}", bold(stdout, word.name), word.kind, wrapped(word.meaning));
  if (word.kind == kMotion) text += "  in numbers: hapbench describe stability\n";
  return {text, {{"kind", word.kind}, {"name", word.name}, {"meaning", word.meaning}}};
}

std::vector<Word> all_words() {
  std::vector<Word> all(std::begin(kWords), std::end(kWords));
  for (const OutcomeInfo& outcome : outcome_infos()) all.push_back({outcome.name, kOutcome, outcome.meaning});
  for (const RunVerdict verdict : kRunVerdicts)
    all.push_back({run_verdict_name(verdict), kMotion, run_verdict_meaning(verdict)});
  for (const Verdict verdict : kVerdicts) all.push_back({verdict_name(verdict), kVerdict, text_of(verdict).meaning});
  return all;
}

Description describe_words() {
  Description d{"words that the program prints\n\n", {{"kind", "words"}, {"words", Json::array()}}};
  for (const Word& word : all_words()) {
    d.text += fmt::format("  {} ({})\n{}", word.name, word.kind, wrapped(word.meaning, 6));
    d.json["words"].push_back(describe_word(word).json);
  }
  return d;
}

Description describe_heading(const Table::Column& heading) {
  const std::string title = heading.title.substr(0, heading.title.find_last_not_of(' ') + 1);
  return {fmt::format("heading \"{}\"\n{}", title, wrapped(heading.meaning)),
          {{"kind", "heading"}, {"name", heading.title}, {"meaning", heading.meaning}}};
}

}  // namespace

std::vector<DescribedTable> result_tables() {
  std::vector<DescribedTable> tables;
  const auto add = [&tables](const char* file, const char* holds, std::span<const Column> columns) {
    DescribedTable& table = tables.emplace_back(DescribedTable{file, holds});
    for (const auto& [name, unit, meaning] : columns) table.columns.push_back({name, unit, meaning});
  };
  for (const ResultTable& table : record_tables()) add(table.file, table.holds, table.columns);
  add(kTargetTable.file, kTargetTable.holds, kTargetTable.columns);
  for (auto* tables_of : {run_tables, league_tables, limit_tables, converge_tables, tune_tables, claim_tables,
                          sweep_tables, stress_tables})
    std::ranges::move(tables_of(), std::back_inserter(tables));
  add("shell.csv", "of shell: one line per point of the environment", kShellColumns);
  return tables;
}

void add_results(Index& index, const std::vector<DescribedTable>& tables) {
  for (const char* name : {"metrics", "summary.json"}) index.push_back({"section", name, "", describe_metrics});
  for (const Metric& metric : metrics_without_values())
    index.push_back({"metric", metric.name, metric.meaning, [metric] { return describe_metric(metric); }});
  for (const char* name : {"columns", "columns.json"}) index.push_back({"section", name, "", describe_tables});
  for (const DescribedTable& table : tables)
    if (!table.file.empty()) index.push_back({"file", table.file, "", [table] { return describe_table(table); }});
  for (const SharedColumn& column : all_columns(tables))
    index.push_back({"column", column.column.name, "", [column] { return describe_column(column); }});
}

void add_words(Index& index) {
  index.push_back({"section", "words", "", describe_words});
  for (const Word& word : all_words())
    index.push_back({word.kind, std::string(word.name), "", [word] { return describe_word(word); }});
}

void add_headings(Index& index, const std::vector<DescribedTable>& tables) {
  for (const DescribedTable& table : tables) {
    for (const Table::Column& heading : table.headings) {
      if (!heading.meaning.empty())
        index.push_back({"heading", heading.title, heading.meaning, [heading] { return describe_heading(heading); }});
    }
  }
}

}  // namespace hapbench
