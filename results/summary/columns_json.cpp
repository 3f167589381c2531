#include "results/summary/columns_json.hpp"

#include <nlohmann/json.hpp>

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
