#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"

namespace hapbench {

/// Every table among the results of this program, and those that are only printed, without a file.
std::vector<DescribedTable> result_tables();

}  // namespace hapbench
