#include "scenarios/batch/csv_cells.hpp"

#include "results/io/columns.hpp"

namespace hapbench {

std::vector<std::string> csv_cells(std::string_view line, char separator) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string> cells(1);
  bool in_quotes = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && in_quotes && line.substr(i + 1).starts_with('"')) {
      cells.back() += line[++i];
    } else if (line[i] == '"') {
      in_quotes = !in_quotes;
    } else if (line[i] == separator && !in_quotes) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  // Remove the apostrophe that csv_cell() puts before a text that resembles a formula.
  for (std::string& cell : cells)
    if (cell.starts_with('\'') && resembles_formula(cell)) cell.erase(0, 1);
  return cells;
}

}  // namespace hapbench
