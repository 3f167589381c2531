#include "scenarios/input/csv_reader.hpp"

#include <fmt/format.h>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

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
  const auto row = lines_.next();
  if (!row) return false;
  row_ = *row;
  cells_ = cells_of(row_);
  if (cells_.size() != columns_.size())
    fail_in_line(file_, line(), fmt::format("got {} cells; allowed: {}", cells_.size(), columns_.size()));
  return true;
}

bool CsvReader::next_not_blank() {
  for (LineReader after = lines_; const auto row = after.next(); lines_ = after) {
    if (!trimmed(*row).empty()) return next();
  }
  return false;
}

}  // namespace hapbench
