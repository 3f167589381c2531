#pragma once

#include <span>
#include <string>

namespace hapbench {

/// A column of a result file: what its header, `hapbench describe` and columns.json say of it.
struct Column {
  const char* name;
  const char* unit;     ///< "1" for pure numbers and counts, empty for text
  const char* meaning;  ///< in a sentence without its full stop; f is f_render, the force on the tool
};

/// A kind of CSV file among the results.
struct ResultTable {
  const char* file;   ///< its name
  const char* holds;  ///< what a line is, and when it is written
  std::span<const Column> columns;
};

/// The header line without its end: the names, separated by commas.
inline std::string header_of(std::span<const Column> columns) {
  std::string header;
  for (const Column& column : columns) header += (header.empty() ? "" : ",") + std::string(column.name);
  return header;
}

/// What most tables of rows begin with.
inline constexpr Column kStepColumn = {"step", "1", "row number k, from 0"};
inline constexpr Column kTimeColumn = {"time_s", "s", "time of the row, k times the time step"};

}  // namespace hapbench
