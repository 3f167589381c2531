#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Splits a line of a CSV table, such as sweep.csv or a file of --points.
namespace hapbench {

/// Returns the cells of a line of a table, without quotes and without a carriage return at the end of the line. Also
/// removes the apostrophe that csv_cell() puts before a text that resembles a formula.
std::vector<std::string> csv_cells(std::string_view line, char separator = ',');

}  // namespace hapbench
