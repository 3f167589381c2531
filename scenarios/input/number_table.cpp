#include "scenarios/input/number_table.hpp"

#include <fmt/format.h>

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

NumberTable number_table_in(std::string_view text, const std::filesystem::path& file, const std::string& header,
                            std::size_t most_rows) {
  if (text.empty()) fail_in_line(file, 1, fmt::format("the file is empty; allowed: header \"{}\" and rows", header));
  CsvReader csv{LineReader(text), file};
  if (csv.header() != header)
    fail_in_line(file, 1, fmt::format("got header {}; allowed: \"{}\"", quoted(csv.header()), header));
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

}  // namespace hapbench
