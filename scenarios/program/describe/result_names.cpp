#include "scenarios/program/describe/result_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "results/summary/summary.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/thesis/claims.hpp"

namespace hapbench {
namespace {

struct PrintedName {
  const char *name, *kind, *meaning;
};

constexpr const char* kTime = "number of timing.json";
constexpr const char* kResultFile = "file of the results";

/// Printed names that no enumeration defines.
constexpr PrintedName kPrintedNames[] = {
    {"step_p50_s", kTime, "median wall time of one step, without observers and recorders [s]"},
    {"step_p99_s", kTime, "99th percentile of the wall time of one step, without observers and recorders [s]"},
    {"tolerances", "object of summary.json",
     "errors of metrics: for each metric whose method has an error bound, the largest error, in the unit of the "
     "metric"},
    {"scenario.effective.json", kResultFile,
     "the scenario with the value of every field, defaults included; running this file gives the same result files"},
    {"timing.json", kResultFile,
     "with record.timing: wall times of the steps, with percentiles, missed deadlines and a histogram"},
    {"sweep.json", kResultFile, "definition of a sweep: scenario, overrides, points, named files and program"},
    {"sweep.csv.part", kResultFile,
     "finished rows of a sweep that is running or was interrupted; --resume continues from them"},
    {"sweep.I_of_N.csv", kResultFile,
     "rows of one shard of a sweep; \"hapbench sweep FOLDER\" joins the shards; columns as in sweep.csv"},
    {"report.html", kResultFile, "page with results and replay, written by report and scripts/reproduce"},
    {"plot.svg", kResultFile, "picture written by plot"},
    {"figures.json", kResultFile, "figures drawn by scripts/figures, with their captions and source files"},
    {"claims.json", kResultFile, "ledger written by reproduce: claims, measured values, verdicts, robustness"},
    {"claims.md", kResultFile, "ledger written by reproduce, as Markdown for readers"},
    {"claim_pages.md", kResultFile, "written by reproduce: a section for each claim, with rule, cases and sensitivity"},
    {"assumptions.json", kResultFile,
     "assumptions: what the thesis leaves open, and the value that the reproduction uses; \"describe "
     "assumptions_schema\" explains the format"},
    {"sensitivity.json", kResultFile,
     "written by reproduce --sensitivity: verdict and number of each claim for each plausible value of each "
     "assumption, one at a time"},
    {"quantum", "number of import",
     "resolution of a recording along an axis: smallest step between the recorded coordinates (quantum_m with "
     "--json); K times this step is the force step that the recording alone causes"}};

Json printed_names() {
  Json all = Json::array();
  const auto add = [&all](std::string_view name, const char* kind, std::string_view meaning) {
    all.push_back({{"kind", kind}, {"name", name}, {"meaning", meaning}});
  };
  for (const auto& [name, kind, meaning] : kPrintedNames) add(name, kind, meaning);
  for (const OutcomeInfo& outcome : outcome_infos()) {
    const std::string early = outcome.ends_early == nullptr
                                  ? ""
                                  : fmt::format(". `compare` and `sweep` end such a run {}", outcome.ends_early);
    add(outcome.name, "outcome of a run", outcome.meaning + early);
  }
  for (const RunVerdictText& verdict : run_verdict_texts())
    add(verdict.name, "class of motion, of limit and stability", verdict.meaning);
  for (const Diagnosed& rule : diagnosis_rules())
    add(rule.rule, "rule of the diagnosis",
        fmt::format("applies above {}: {}", with_unit(rule.threshold, rule.unit), rule.number));
  for (const auto& [name, meaning] : kVerdicts) add(name, "verdict on a claim", meaning);
  return all;
}

void add_term(Index& index, const Json& json, const Layout& layout) {
  const auto text = [&](const char* key) { return json.at(key).get<std::string>(); };
  index.push_back(
      {text("kind"), text("name"), text("meaning"), [json, layout] { return entry_description(json, layout); }});
}

}  // namespace

Description describe_metrics(const Layout& layout) {
  const Json json = {{"kind", "metrics"}, {"metrics", columns_json({}, all_metrics())["summary.json"]}};
  return {
      "metrics of summary.json; expect.metrics can bound each of them. f is f_render, the rendered force on the tool; "
      "a step is one time step of the run\n" +
          entry_text(json, layout),
      json};
}

Description describe_table(const DescribedTable& table, const Layout& layout) {
  Json columns = Json::array();
  for (const auto& [name, unit, meaning] : table.columns)
    columns.push_back({{"name", name}, {"unit", unit}, {"meaning", meaning}});
  return entry_description(
      {{"kind", "file"}, {"name", table.file}, {"holds", table.holds}, {"columns", std::move(columns)}}, layout);
}

Description describe_tables(const Layout& layout) {
  std::vector<Description> all;
  for (const DescribedTable& table : result_tables())
    if (!table.file.empty()) all.push_back(describe_table(table, layout));
  return joined(all);
}

Description describe_printed_names(const Layout& layout) {
  const Json json = {{"kind", "words"}, {"words", printed_names()}};
  return {"terms that the program prints\n" + entry_text(json, layout), json};
}

void add_metric_terms(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout) {
  for (const Metric& metric : all_metrics()) {
    Json json = {{"kind", "metric"}, {"name", metric.name}, {"unit", metric.unit}, {"meaning", metric.meaning}};
    if (const std::string condition = condition_of_metric(metric.name); !condition.empty()) json["only"] = condition;
    for (const DescribedTable& table : tables)
      for (const auto& column : table.columns)
        if (!table.file.empty() && column.name == metric.name && column.meaning == metric.meaning)
          json["files"].push_back(table.file);
    add_term(index, json, layout);
  }
}

void add_columns(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout) {
  std::vector<Json> all;
  const auto add = [&all](const char* kind, const DescribedTable::Entry& entry, const char* files,
                          const std::string& file) {
    Json named = {{"kind", kind}, {"name", entry.name}, {"unit", entry.unit}, {"meaning", entry.meaning}};
    const auto same = std::ranges::find_if(all, [&named](const Json& known) {
      return known["kind"] == named["kind"] && known["name"] == named["name"] && known["meaning"] == named["meaning"];
    });
    (same != all.end() ? *same : all.emplace_back(std::move(named)))[files].push_back(file);
  };
  for (const DescribedTable& table : tables) {
    if (table.file.empty()) continue;
    for (const auto& [name, unit, meaning] : table.columns) {
      // Skip the column of a metric: add_metric_terms() adds an entry that names the files with this column.
      const Metric* metric = find_metric(all_metrics(), name);
      if (metric != nullptr && metric->meaning == meaning) continue;
      add("column", {name, unit, meaning}, "files", table.file);
    }
    for (const DescribedTable::Entry& entry : table.json_only) add(kJsonKey, entry, "rows_as_in", table.file);
  }
  for (const Json& column : all) add_term(index, column, layout);
}

void add_printed_names(Index& index, const Layout& layout) {
  for (const Json& word : printed_names()) add_term(index, word, layout);
}

void add_headings(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout) {
  for (const DescribedTable& table : tables)
    for (const Table::Column& heading : table.headings)
      if (!heading.meaning.empty())
        add_term(index, {{"kind", "heading"}, {"name", heading.title}, {"meaning", heading.meaning}}, layout);
}

}  // namespace hapbench
