#include "scenarios/input/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/input/csv_reader.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {
namespace {

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  return fmt::format("\"{}{}\"", text.substr(0, kLongest), text.size() > kLongest ? "..." : "");
}

}  // namespace

std::string read_named_file(const std::filesystem::path& file) {
  try {
    return read_text_file(file, kLargestTable);
  } catch (const InputError& error) {
    fail_in_file(file, error.problem());
  }
}

NumberTable number_table_in(std::string_view text, const std::filesystem::path& file,
                            std::span<const std::string_view> headers, std::size_t most_rows) {
  const auto allowed = [headers] { return fmt::format("\"{}\"", fmt::join(headers, "\" or \"")); };
  if (text.empty()) fail_in_line(file, 1, fmt::format("the file is empty; allowed: header {} and rows", allowed()));
  CsvReader csv{LineReader(text), file};
  if (std::find(headers.begin(), headers.end(), csv.header()) == headers.end())
    fail_in_line(file, 1, fmt::format("got header {}; allowed: {}", quoted(csv.header()), allowed()));
  NumberTable table;
  table.columns = csv.columns().size();
  while (csv.next_not_blank()) {
    for (std::size_t i = 0; i < table.columns; ++i) {
      const auto value = finite_number(csv.cells()[i]);
      if (!value) {
        fail_in_line(file, csv.line(),
                     fmt::format("column {}: got {}; allowed: a finite number", i + 1, quoted(csv.cells()[i])));
      }
      table.values.push_back(*value);
    }
    if (table.rows() > most_rows) fail_in_line(file, csv.line(), fmt::format("more than {} rows", most_rows));
  }
  return table;
}

NumberTable number_table_in(std::string_view text, const std::filesystem::path& file, std::string_view header,
                            std::size_t most_rows) {
  return number_table_in(text, file, std::span(&header, 1), most_rows);
}

}  // namespace hapbench
