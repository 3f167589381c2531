#include "scenarios/input/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t line, const std::string& problem) {
  throw InputError(InputError::Kind::relation, fmt::format("{}, line {}", file.string(), line), problem);
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  return fmt::format("\"{}{}\"", text.substr(0, kLongest), text.size() > kLongest ? "..." : "");
}

double read_cell(std::string_view cell, const std::filesystem::path& file, std::size_t line, std::size_t column) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    fail(file, line, fmt::format("column {}: got {}; allowed: a finite number", column, quoted(cell)));
  }
  return value;
}

void read_row(std::string_view row, NumberTable& table, const std::filesystem::path& file, std::size_t line) {
  const auto cells = static_cast<std::size_t>(1 + std::count(row.begin(), row.end(), ','));
  if (cells != table.columns) fail(file, line, fmt::format("got {} cells; allowed: {}", cells, table.columns));
  for (std::size_t column = 1; column <= cells; ++column) {
    const std::size_t comma = row.find(',');
    table.values.push_back(read_cell(trimmed(row.substr(0, comma)), file, line, column));
    row.remove_prefix(comma == std::string_view::npos ? row.size() : comma + 1);
  }
}

}  // namespace

std::string read_named_file(const std::filesystem::path& file) {
  try {
    return read_text_file(file, kLargestTable);
  } catch (const InputError& error) {
    throw InputError(InputError::Kind::relation, file.string(), error.problem());
  }
}

NumberTable read_number_table(const std::filesystem::path& file, const std::string& header, std::size_t most_rows) {
  const std::string text = read_named_file(file);
  NumberTable table;
  table.columns = static_cast<std::size_t>(1 + std::count(header.begin(), header.end(), ','));
  std::string_view rest = text;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = rest.find('\n');
    const std::string_view row = trimmed(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line == 1) {
      if (row != header) fail(file, line, fmt::format("got header {}; allowed: \"{}\"", quoted(row), header));
    } else if (!row.empty()) {
      read_row(row, table, file, line);
      if (table.rows() > most_rows) fail(file, line, fmt::format("more than {} rows", most_rows));
    }
  }
  if (text.empty()) fail(file, 1, fmt::format("the file is empty; allowed: header \"{}\" and rows", header));
  return table;
}

}  // namespace hapbench
