#pragma once

#include <string>
#include <vector>

#include "scenarios/studies/precision/measure.hpp"

namespace hapbench::test {

/// Every timing is made once, since no test reads it.
PrecisionOptions quick();

Scenario bundled(const std::string& name, const std::vector<std::string>& overrides = {});

/// A value of a result; NaN where the run failed. Throws std::invalid_argument when there is no such column.
double value(const PrecisionResult& result, std::size_t row, const std::string& column);

}  // namespace hapbench::test
