#include "scenarios/program/latency_table.hpp"

#include <fmt/format.h>

namespace hapbench {
namespace {

std::vector<Table::Column> columns() {
  std::vector<Table::Column> columns = {
      {"step latency", false}, {"steps"}, {"p50 us"}, {"p95 us"}, {"p99 us"}, {"p99.9 us"}, {"max us"}};
  for (const double deadline : kStepDeadlines) columns.push_back({fmt::format("> {:.3f} ms", 1e3 * deadline)});
  columns.push_back({"clock us"});
  return columns;
}

}  // namespace

LatencyTable::LatencyTable() : table_(columns()) {}

void LatencyTable::add(const std::string& name, const StepLatency& latency) {
  const auto us = [&latency](std::uint64_t ns) {
    return latency.steps > 0 ? fmt::format("{:.3f}", static_cast<double>(ns) / 1e3) : "-";
  };
  std::vector<std::string> cells = {name,
                                    std::to_string(latency.steps),
                                    us(latency.p50),
                                    us(latency.p95),
                                    us(latency.p99),
                                    us(latency.p99_9),
                                    us(latency.max)};
  for (const std::uint64_t misses : latency.misses) cells.push_back(std::to_string(misses));
  cells.push_back(us(latency.overhead));
  table_.add(std::move(cells));
}

}  // namespace hapbench
