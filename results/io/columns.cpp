#include "results/io/columns.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "results/io/json_text.hpp"

namespace hapbench {
namespace {

using nlohmann::ordered_json;

/// Of columns or metrics.
template <class Entries>
ordered_json entries_json(const Entries& entries) {
  ordered_json json = ordered_json::array();
  for (const auto& entry : entries) {
    json.push_back({{"name", entry.name}, {"unit", entry.unit}, {"meaning", entry.meaning}});
  }
  return json;
}

}  // namespace

Metric Metric::number(const char* name, const char* unit, const char* meaning, std::optional<double> value) {
  return {name, unit, meaning, value && std::isfinite(*value) ? Value(*value) : Value()};
}

Metric Metric::number_if(bool exists, const char* name, const char* unit, const char* meaning, double value) {
  return number(name, unit, meaning, exists ? std::optional(value) : std::nullopt);
}

Metric Metric::count(const char* name, const char* meaning, std::optional<std::uint64_t> value) {
  return {name, "1", meaning, value ? Value(*value) : Value()};
}

Metric::Value value_of(const MetricList& list, std::string_view name) {
  const auto metric = std::find_if(list.begin(), list.end(), [name](const Metric& m) { return m.name == name; });
  return metric != list.end() ? metric->value : Metric::Value();
}

std::optional<double> number_of(const Metric::Value& value) {
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*count);
  const auto* real = std::get_if<double>(&value);
  return real != nullptr ? std::optional(*real) : std::nullopt;
}

std::string cell_text(const Metric::Value& value) {
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return std::to_string(*count);
  const auto* number = std::get_if<double>(&value);
  return number != nullptr ? std::string(NumberText(*number)) : "";
}

void append(MetricList& list, std::string_view section, const MetricList& more) {
  const std::string prefix = section.empty() ? "" : std::string(section) + ".";
  for (const Metric& metric : more) list.push_back({prefix + metric.name, metric.unit, metric.meaning, metric.value});
}

ordered_json columns_json(std::span<const Column> columns) {
  return entries_json(columns);
}

ordered_json columns_json(const MetricList& metrics) {
  return entries_json(metrics);
}

ordered_json columns_json(std::span<const ResultTable> tables, const MetricList& metrics) {
  ordered_json json = {{"summary.json", columns_json(metrics)}};
  for (const ResultTable& table : tables) json[table.file] = columns_json(table.columns);
  return json;
}

}  // namespace hapbench
