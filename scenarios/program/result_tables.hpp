#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"

namespace hapbench {

/// Returns all tables of result files, and the tables that are only printed, whose `file` is empty.
std::vector<DescribedTable> result_tables();

}  // namespace hapbench
