#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "results/io/columns.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/describe.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/studies/stability/judged_run.hpp"
#include "scenarios/thesis_claims/claims.hpp"

namespace hapbench {
namespace {

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

Json columns_json(const DescribedTable& table) {
  Json columns = Json::array();
  for (const DescribedTable::Entry& column : table.columns)
    columns.push_back({{"name", column.name}, {"unit", column.unit}, {"meaning", column.meaning}});
  return columns;
}

Description describe_table(const DescribedTable& table) {
  return {fmt::format("file {}\n{}\n{}", table.file, wrapped(table.holds), entries_text(table.columns)),
          {{"kind", "file"}, {"name", table.file}, {"holds", table.holds}, {"columns", columns_json(table)}}};
}

/// Explains a column that one or several files have.
Description describe_column(const DescribedTable::Entry& column, const std::vector<std::string>& files) {
  return {fmt::format("column {} of {}\n{}", titled(column.name, column.unit), fmt::join(files, ", "),
                      wrapped(column.meaning)),
          {{"kind", "column"},
           {"name", column.name},
           {"unit", column.unit},
           {"meaning", column.meaning},
           {"files", files}}};
}

/// The columns of that name, each meaning once.
std::vector<Description> describe_columns(const std::string& name) {
  std::vector<std::pair<DescribedTable::Entry, std::vector<std::string>>> found;
  for (const DescribedTable& table : result_tables()) {
    for (const DescribedTable::Entry& column : table.columns) {
      if (column.name != name) continue;
      const auto same = std::find_if(found.begin(), found.end(),
                                     [&column](const auto& other) { return other.first.meaning == column.meaning; });
      if (same != found.end()) {
        same->second.push_back(table.file);
      } else {
        found.push_back({column, {table.file}});
      }
    }
  }
  std::vector<Description> descriptions;
  for (const auto& [column, files] : found) descriptions.push_back(describe_column(column, files));
  return descriptions;
}

/// True for a file's name, in which capital letters stand for any characters: stability_map_NAME.csv.
bool is_named(std::string_view file, std::string_view name) {
  const auto is_capital = [](unsigned char c) { return std::isupper(c) != 0; };
  const auto first = std::find_if(file.begin(), file.end(), is_capital);
  const auto last = std::find_if(file.rbegin(), file.rend(), is_capital).base();
  if (first == file.end() || file == name) return file == name;
  const std::string_view before(file.begin(), first), after(last, file.end());
  return name.size() > before.size() + after.size() && name.starts_with(before) && name.ends_with(after);
}

}  // namespace

std::vector<Description> describe_results(const std::string& name) {
  if (name == "metrics" || name == "summary.json") return {describe_metrics()};
  const bool all = name == "columns" || name == "columns.json";
  std::vector<Description> found;
  for (const Metric& metric : metrics_without_values()) {
    if (metric.name == name) found.push_back(describe_metric(metric));
  }
  for (const DescribedTable& table : result_tables()) {
    if (all || is_named(table.file, name)) found.push_back(describe_table(table));
  }
  for (Description& column : describe_columns(name)) found.push_back(std::move(column));
  return found;
}

std::vector<std::string> result_names() {
  std::vector<std::string> names = {"metrics", "summary.json", "columns", "columns.json"};
  for (const Metric& metric : metrics_without_values()) names.push_back(metric.name);
  for (const DescribedTable& table : result_tables()) {
    names.push_back(table.file);
    for (const DescribedTable::Entry& column : table.columns) names.push_back(column.name);
  }
  return names;
}

namespace {

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

std::vector<Word> all_words() {
  std::vector<Word> all(std::begin(kWords), std::end(kWords));
  for (const OutcomeInfo& outcome : outcome_infos()) all.push_back({outcome.name, kOutcome, outcome.meaning});
  for (const RunVerdict verdict : kRunVerdicts)
    all.push_back({run_verdict_name(verdict), kMotion, run_verdict_meaning(verdict)});
  for (const Verdict verdict : kVerdicts) all.push_back({verdict_name(verdict), kVerdict, text_of(verdict).meaning});
  return all;
}

Json json_of(const Word& word) {
  return {{"kind", word.kind}, {"name", word.name}, {"meaning", word.meaning}};
}

Description describe_words() {
  Description d{"words that the program prints\n\n", {{"kind", "words"}, {"words", Json::array()}}};
  for (const Word& word : all_words()) {
    d.text += fmt::format("  {} ({})\n{}", word.name, word.kind, wrapped(word.meaning, 6));
    d.json["words"].push_back(json_of(word));
  }
  return d;
}

/// A heading in lower case, without blanks and line breaks.
std::string plain(std::string_view text) {
  std::string plain = lower_case(text);
  std::erase_if(plain, [](unsigned char c) { return std::isspace(c); });
  return plain;
}

}  // namespace

std::vector<Description> describe_word(const std::string& name) {
  if (name == "words") return {describe_words()};
  std::vector<Description> found;
  for (const Word& word : all_words()) {
    if (name != word.name && !(word.kind == kResultFile && is_named(word.name, name))) continue;
    std::string text = fmt::format("{}: {}\n{}", bold(stdout, word.name), word.kind, wrapped(word.meaning));
    if (word.kind == kMotion) text += "  in numbers: hapbench describe stability\n";
    found.push_back({text, json_of(word)});
  }
  return found;
}

std::vector<Description> describe_heading(const std::string& name) {
  std::vector<Description> found;
  for (const Table::Column& heading : printed_headings()) {
    const std::string_view title = heading.title, first = title.substr(0, title.find('\n'));
    if (heading.meaning.empty() || (plain(name) != plain(title) && plain(name) != plain(first))) continue;
    std::vector<Description> meant = describe_results(heading.meaning);  // of a metric, before columns
    if (meant.empty()) meant = describe_word(heading.meaning);
    if (meant.empty()) {
      meant.push_back({fmt::format("heading \"{}\"\n{}", title.substr(0, title.find_last_not_of(' ') + 1),
                                   wrapped(heading.meaning)),
                       {{"kind", "heading"}, {"name", title}, {"meaning", heading.meaning}}});
    }
    const auto same = [&meant](const Description& other) { return other.text == meant.front().text; };
    if (std::none_of(found.begin(), found.end(), same)) found.push_back(std::move(meant.front()));
  }
  return found;
}

std::vector<std::string> described_words() {
  std::vector<std::string> names = {"words"};
  for (const Word& word : all_words()) names.emplace_back(word.name);
  return names;
}

}  // namespace hapbench
