#include "tests/scenarios/studies/precision/results.hpp"

#include <cmath>
#include <stdexcept>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"

namespace hapbench::test {

PrecisionOptions quick() {
  PrecisionOptions options;
  options.repetitions = 1;
  return options;
}

Scenario bundled(const std::string& name, const std::vector<std::string>& overrides) {
  return load_scenario(find_scenario(name), overrides).scenario;
}

double value(const PrecisionResult& result, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < result.columns.size(); ++i) {
    if (result.columns[i] == column) return result.rows.at(row).values.at(i).value_or(std::nan(""));
  }
  throw std::invalid_argument(column);
}

}  // namespace hapbench::test
