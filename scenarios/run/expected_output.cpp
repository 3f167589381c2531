#include "scenarios/run/expected_output.hpp"

#include <cmath>
#include <string_view>

#include "scenarios/run/recorders.hpp"

namespace hapbench {
namespace {

constexpr double kBytesOfANumber = 12.0;  // between a zero and seventeen digits
constexpr double kContactsOfARow = 30.0;

double lines_a_row(const ResultTable& table, const RecordFields& record) {
  const std::string_view file = table.file;
  if (file == "contacts.csv") return kContactsOfARow;
  return file == "ratios.csv" ? static_cast<double>(record.ratio_iterations.size()) : 1.0;
}

}  // namespace

double expected_output_bytes(const Scenario& scenario) {
  const RecordFields& record = scenario.record;
  double row = 0.0;
  for (const ResultTable& table : record_tables(record))
    row += lines_a_row(table, record) * kBytesOfANumber * static_cast<double>(table.columns.size());
  const double rows = std::ceil(static_cast<double>(scenario.time.steps) / static_cast<double>(record.every));
  return trial_count(scenario.hand) * rows * row;
}

}  // namespace hapbench
