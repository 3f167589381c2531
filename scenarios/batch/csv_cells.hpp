#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Splits a line of a CSV table, such as sweep.csv or a file of --points.
namespace hapbench {

/// The cells of a line of a table, without their quotes and a carriage return at its end.
std::vector<std::string> csv_cells(std::string_view line);

}  // namespace hapbench
