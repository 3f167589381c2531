#include "scenarios/program/describe/result_names.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "results/summary/summary.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/thesis/claims.hpp"

namespace hapbench {
namespace {

struct Word {
  const char *name, *kind, *meaning;
};

constexpr const char* kTime = "number of timing.json";
constexpr const char* kResultFile = "file of the results";

/// Printed names that no enumeration defines.
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
    {"report.html", kResultFile, "a page to read and replay, of report or scripts/reproduce"},
    {"plot.svg", kResultFile, "the picture of plot"},
    {"figures.json", kResultFile,
     "figures that scripts/figures drew, with their captions and the files they were drawn of"},
    {"claims.json", kResultFile, "the ledger of reproduce: claims, what was measured, verdicts, robustness"},
    {"claims.md", kResultFile, "the ledger of reproduce, for people"},
    {"choices.json", kResultFile, "what the thesis leaves open and what was chosen; \"describe choices_schema\""},
    {"robustness.csv", kResultFile, "of reproduce --choices: the choices and verdicts of each reading"},
    {"robustness.json", kResultFile,
     "how many samples have the verdict on record, and which choices decide it, for each claim"},
    {"quantum", "number of import",
     "the step in which the recorded places come along an axis, seen in their differences (its row resolution, "
     "quantum_m of --json); K times it is the step of force that the recording alone makes"}};

Json all_words() {
  Json all = Json::array();
  const auto add = [&all](std::string_view name, const char* kind, const char* meaning) {
    all.push_back({{"kind", kind}, {"name", name}, {"meaning", meaning}});
  };
  for (const auto& [name, kind, meaning] : kWords) add(name, kind, meaning);
  for (const OutcomeInfo& outcome : outcome_infos()) add(outcome.name, "outcome of a run", outcome.meaning);
  for (const RunVerdictText& verdict : run_verdict_texts())
    add(verdict.name, "class of motion, of limit and stability", verdict.meaning);
  for (const auto& [name, meaning, mark] : kVerdicts) add(name, "verdict on a claim", meaning);
  return all;
}

void add_term(Index& index, const Json& json, const Layout& layout) {
  const auto text = [&](const char* key) { return json.at(key).get<std::string>(); };
  index.push_back(
      {text("kind"), text("name"), text("meaning"), [json, layout] { return thing_description(json, layout); }});
}

}  // namespace

Description describe_metrics(const Layout& layout) {
  const Json json = {{"kind", "metrics"}, {"metrics", columns_json({}, all_metrics())["summary.json"]}};
  return {"metrics of summary.json, which expect.metrics may bound; f is f_render, the force on the tool\n" +
              thing_text(json, layout),
          json};
}

Description describe_table(const DescribedTable& table, const Layout& layout) {
  Json columns = Json::array();
  for (const auto& [name, unit, meaning] : table.columns)
    columns.push_back({{"name", name}, {"unit", unit}, {"meaning", meaning}});
  return thing_description(
      {{"kind", "file"}, {"name", table.file}, {"holds", table.holds}, {"columns", std::move(columns)}}, layout);
}

Description describe_tables(const Layout& layout) {
  std::vector<Description> all;
  for (const DescribedTable& table : result_tables())
    if (!table.file.empty()) all.push_back(describe_table(table, layout));
  return joined(all);
}

Description describe_words(const Layout& layout) {
  const Json json = {{"kind", "words"}, {"words", all_words()}};
  return {"words that the program prints\n" + thing_text(json, layout), json};
}

void add_metric_terms(Index& index, const Layout& layout) {
  for (const Metric& metric : all_metrics())
    add_term(index, {{"kind", "metric"}, {"name", metric.name}, {"unit", metric.unit}, {"meaning", metric.meaning}},
             layout);
}

void add_columns(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout) {
  std::vector<Json> all;
  for (const DescribedTable& table : tables) {
    if (table.file.empty()) continue;
    for (const auto& [name, unit, meaning] : table.columns) {
      Json column = {{"kind", "column"}, {"name", name}, {"unit", unit}, {"meaning", meaning}};
      const auto same = std::ranges::find_if(all, [&column](const Json& known) {
        return known["name"] == column["name"] && known["meaning"] == column["meaning"];
      });
      (same != all.end() ? *same : all.emplace_back(std::move(column)))["files"].push_back(table.file);
    }
  }
  for (const Json& column : all) add_term(index, column, layout);
}

void add_words(Index& index, const Layout& layout) {
  for (const Json& word : all_words()) add_term(index, word, layout);
}

void add_headings(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout) {
  for (const DescribedTable& table : tables)
    for (const Table::Column& heading : table.headings)
      if (!heading.meaning.empty())
        add_term(index, {{"kind", "heading"}, {"name", heading.title}, {"meaning", heading.meaning}}, layout);
}

}  // namespace hapbench
