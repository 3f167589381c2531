#include "scenarios/input/number_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

/// Splits a row into cells and trims them.
Words cells_of(std::string_view row) {
  Words cells = parts_of(row, ',');
  for (std::string_view& cell : cells) cell = trimmed(cell);
  return cells;
}

}  // namespace

CsvReader::CsvReader(LineReader lines, const std::filesystem::path& file) : lines_(lines), file_(file) {
  header_ = trimmed(lines_.next().value_or(""));
  columns_ = cells_of(header_);
}

bool CsvReader::next() {
  auto row = lines_.next();
  while (row && trimmed(*row).empty()) row = lines_.next();
  if (!row) return false;
  cells_ = cells_of(*row);
  if (cells_.size() != columns_.size())
    fail_in_line(file_, line(), fmt::format("got {} cells; allowed: {}", cells_.size(), columns_.size()));
  return true;
}

NumberTable parse_number_table(std::string_view text, const std::filesystem::path& file,
                               std::initializer_list<std::string_view> headers, std::size_t max_rows) {
  // Check the header.
  const auto allowed = [headers] { return fmt::format("\"{}\"", fmt::join(headers, "\" or \"")); };
  if (text.empty()) fail_in_line(file, 1, fmt::format("the file is empty; allowed: header {} and rows", allowed()));
  CsvReader csv{LineReader(text), file};
  if (std::find(headers.begin(), headers.end(), csv.header()) == headers.end())
    fail_in_line(file, 1, fmt::format("got header {}; allowed: {}", quoted_token(csv.header()), allowed()));
  // Parse the rows.
  NumberTable table;
  table.columns = csv.columns().size();
  while (csv.next()) {
    for (std::size_t i = 0; i < table.columns; ++i) {
      const auto value = finite_number(csv.cells()[i]);
      if (!value) {
        fail_in_line(file, csv.line(),
                     fmt::format("column {}: got {}; allowed: a finite number", i + 1, quoted_token(csv.cells()[i])));
      }
      table.values.push_back(*value);
    }
    if (table.rows() > max_rows) fail_in_line(file, csv.line(), fmt::format("more than {} rows", max_rows));
  }
  return table;
}

}  // namespace hapbench
