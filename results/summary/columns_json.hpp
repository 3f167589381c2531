#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "results/io/columns.hpp"
#include "results/summary/metric_list.hpp"

namespace hapbench {

/// columns.json, for other programs: for each file its columns, and for summary.json its metrics, each with name, unit
/// and meaning.
nlohmann::ordered_json columns_json(std::span<const ResultTable> tables, const MetricList& metrics);

/// Those of one file, and the metrics alone.
nlohmann::ordered_json columns_json(std::span<const Column> columns);
nlohmann::ordered_json columns_json(const MetricList& metrics);

}  // namespace hapbench
