#include "scenarios/input/text_lines.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {
namespace {

constexpr std::uintmax_t kLargestTable = std::uintmax_t{4} << 30;  ///< that is read [bytes]

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

Words words_of(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r\v\f";
  Words words;
  for (std::size_t start = line.find_first_not_of(kBlank); start != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, start), line.size());
    words.push_back(line.substr(start, end - start));
    start = line.find_first_not_of(kBlank, end);
  }
  return words;
}

Words parts_of(std::string_view text, char separator) {
  Words parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(separator, start), text.size());
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

std::optional<double> finite_number(std::string_view word) {
  const auto value = whole_word_as<double>(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::string quoted_word(std::string_view word) {
  return shown(word.substr(0, 60));
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::optional<std::string_view> LineReader::next() {
  if (rest_.empty()) return std::nullopt;
  ++line_;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  const std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  return line;
}

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

std::string read_named_file(const std::filesystem::path& file) {
  try {
    return read_text_file(file, kLargestTable);
  } catch (const InputError& error) {
    fail_in_file(file, error.problem());
  }
}

NumberTable number_table_in(std::string_view text, const std::filesystem::path& file,
                            std::initializer_list<std::string_view> headers, std::size_t most_rows) {
  const auto allowed = [headers] { return fmt::format("\"{}\"", fmt::join(headers, "\" or \"")); };
  if (text.empty()) fail_in_line(file, 1, fmt::format("the file is empty; allowed: header {} and rows", allowed()));
  CsvReader csv{LineReader(text), file};
  if (std::find(headers.begin(), headers.end(), csv.header()) == headers.end())
    fail_in_line(file, 1, fmt::format("got header {}; allowed: {}", quoted_word(csv.header()), allowed()));
  NumberTable table;
  table.columns = csv.columns().size();
  while (csv.next()) {
    for (std::size_t i = 0; i < table.columns; ++i) {
      const auto value = finite_number(csv.cells()[i]);
      if (!value) {
        fail_in_line(file, csv.line(),
                     fmt::format("column {}: got {}; allowed: a finite number", i + 1, quoted_word(csv.cells()[i])));
      }
      table.values.push_back(*value);
    }
    if (table.rows() > most_rows) fail_in_line(file, csv.line(), fmt::format("more than {} rows", most_rows));
  }
  return table;
}

}  // namespace hapbench
