#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/studies/precision/measure.hpp"

namespace hapbench::test {

/// Measures every time once, since no test reads it.
inline PrecisionOptions quick() {
  return {.repetitions = 1};
}

inline Scenario bundled(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return load_scenario(find_scenario(name), overrides).scenario;
}

/// A value of a result; NaN where the run failed. Throws std::invalid_argument when there is no such column.
inline double value(const PrecisionResult& result, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < result.columns.size(); ++i) {
    if (result.columns[i] == column) return result.rows.at(row).values.at(i).value_or(std::nan(""));
  }
  throw std::invalid_argument(column);
}

}  // namespace hapbench::test
