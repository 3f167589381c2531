#include "scenarios/program/describe_results.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "results/io/columns.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

std::string titled(std::string_view name, std::string_view unit) {
  return unit.empty() ? std::string(name) : fmt::format("{} [{}]", name, unit);
}

/// Of columns or metrics.
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
  return {fmt::format("file {}\n{}\n{}", table.file, wrapped(table.holds), entries_text(table.columns)),
          {{"kind", "file"}, {"name", table.file}, {"holds", table.holds}, {"columns", columns_json(table.columns)}}};
}

/// A column as one or several files have it.
Description describe_column(const Column& column, const std::vector<std::string>& files) {
  std::string in;
  for (const std::string& file : files) in += (in.empty() ? "" : ", ") + file;
  return {fmt::format("column {} of {}\n{}", titled(column.name, column.unit), in, wrapped(column.meaning)),
          {{"kind", "column"},
           {"name", column.name},
           {"unit", column.unit},
           {"meaning", column.meaning},
           {"files", files}}};
}

/// The columns of that name, each meaning once.
std::vector<Description> describe_columns(const std::string& name) {
  std::vector<std::pair<Column, std::vector<std::string>>> found;
  for (const DescribedTable& table : result_tables()) {
    for (const Column& column : table.columns) {
      if (column.name != name) continue;
      const auto same = std::find_if(found.begin(), found.end(), [&column](const auto& other) {
        return std::string_view(other.first.meaning) == column.meaning;
      });
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

}  // namespace

std::vector<Description> describe_results(const std::string& name) {
  if (name == "metrics" || name == "summary.json") return {describe_metrics()};
  const bool all = name == "columns" || name == "columns.json";
  std::vector<Description> found;
  for (const Metric& metric : metrics_without_values()) {
    if (metric.name == name) found.push_back(describe_metric(metric));
  }
  for (const DescribedTable& table : result_tables()) {
    if (all || table.file == name) found.push_back(describe_table(table));
  }
  for (Description& column : describe_columns(name)) found.push_back(std::move(column));
  return found;
}

std::vector<std::string> result_names() {
  std::vector<std::string> names = {"metrics", "summary.json", "columns", "columns.json"};
  for (const Metric& metric : metrics_without_values()) names.push_back(metric.name);
  for (const DescribedTable& table : result_tables()) {
    names.push_back(table.file);
    for (const Column& column : table.columns) names.emplace_back(column.name);
  }
  return names;
}

}  // namespace hapbench
