#include "scenarios/input/number_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <string>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

/// Returns a cell without white space and double quotes at its ends.
std::string_view unquoted(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = trimmed(cell.substr(1, cell.size() - 2));
  return cell;
}

/// Removes empty cells at the end of a row while it has more than `columns` cells. Separators at the end of a row cause
/// such cells.
void drop_trailing_cells(Words& cells, std::size_t columns) {
  while (cells.size() > columns && cells.back().empty()) cells.pop_back();
}

/// Returns a comment without the characters '#', '%' and white space at its start.
std::string_view comment_text(std::string_view line) {
  line = trimmed(line);
  return line.substr(std::min(line.find_first_not_of("#% \t"), line.size()));
}

HeaderNames names_in(std::string_view line, std::span<const std::string_view> expected) {
  HeaderNames best;
  const auto is_expected = [expected](std::string_view name) {
    return std::ranges::find(expected, name) != expected.end();
  };
  for (const char separator : kSeparators) {
    Words names;
    split_cells(line, separator, names);
    const auto count = static_cast<std::size_t>(std::ranges::count_if(names, is_expected));
    if (count > best.expected) best = {std::move(names), separator, count};
  }
  if (best.expected > 0) return best;
  best.separator = expected.empty() ? ',' : separator_in(line);
  split_cells(line, best.separator, best.names);
  return best;
}

/// Returns the name of a separator for messages.
std::string separator_name(char separator) {
  if (separator == '\t') return "tabs";
  return separator == ' ' ? "white space" : fmt::format("\"{}\"", separator);
}

}  // namespace

void split_cells(std::string_view row, char separator, Words& cells) {
  cells.clear();
  if (separator == ' ') {
    for (std::string_view rest = trimmed(row); !rest.empty(); rest = trimmed(rest)) {
      const auto end = std::ranges::find_if(rest, is_blank) - rest.begin();
      cells.push_back(unquoted(rest.substr(0, static_cast<std::size_t>(end))));
      rest.remove_prefix(static_cast<std::size_t>(end));
    }
    return;
  }
  const bool has_quotes = row.find('"') != std::string_view::npos;
  for (std::size_t start = 0; start <= row.size();) {
    std::size_t end = start;
    if (has_quotes) {
      for (bool in_quotes = false; end < row.size() && (in_quotes || row[end] != separator); ++end)
        if (row[end] == '"') in_quotes = !in_quotes;
    } else {
      while (end < row.size() && row[end] != separator) ++end;
    }
    cells.push_back(unquoted(row.substr(start, end - start)));
    start = end + 1;
  }
}

char separator_in(std::string_view header) {
  for (const char separator : {';', '\t', ','})
    if (header.find(separator) != std::string_view::npos) return separator;
  return std::ranges::any_of(trimmed(header), is_blank) ? ' ' : ',';
}

bool is_comment(std::string_view line) {
  const std::string_view text = trimmed(line);
  const bool names_separator = text.size() <= 5 && text.starts_with("sep=");
  return text.starts_with('#') || text.starts_with('%') || names_separator;
}

bool has_decimal_comma(std::string_view cell) {
  if (cell.starts_with('+')) cell.remove_prefix(1);
  const std::size_t comma = cell.find(',');
  if (comma == std::string_view::npos || cell.find_first_of(".", 0) != std::string_view::npos) return false;
  std::string number(cell);
  number[comma] = '.';
  return finite_number(number).has_value();
}

std::string cause_of_exponent(std::string_view cell) {
  std::string number = lower_case(cell);
  const std::size_t at = number.find('d');
  if (at == std::string::npos) return "";
  number[at] = 'e';
  return finite_number(number.starts_with('+') ? number.substr(1) : number) ? "; write an exponent as in 1e-3" : "";
}

std::string cause_of_cell_count(std::string_view row, char separator, std::size_t cells, std::size_t columns) {
  if (separator == ',' && cells > columns && row.find_first_of("[{") != std::string_view::npos)
    return "; write a list or object in double quotes";
  if (separator == ',' && cells > columns && row.find('.') == std::string_view::npos)
    return "; a decimal comma splits a number: write a decimal point, or separate the columns by \";\"";
  for (const char other : kSeparators) {
    Words words;
    split_cells(row, other, words);
    drop_trailing_cells(words, columns);
    if (cells < columns && other != separator && words.size() == columns)
      return fmt::format("; the row is separated by {}, the header by {}", separator_name(other),
                         separator_name(separator));
  }
  return cells < columns ? "; is the row incomplete, or the file cut off?" : "";
}

void RowFaults::add(std::size_t line, const std::string& problem, const std::string& entry) {
  const bool is_counted = count_ > 0 && line > 0 && line == last_line_;
  last_line_ = line;
  if (is_counted || count_++ > 0) return;
  line_ = line;
  problem_ = problem;
  entry_ = entry;
}

void RowFaults::throw_if_any(const std::filesystem::path& file) const {
  if (count_ == 0) return;
  const std::size_t more = count_ - 1;
  fail_in({.file = file, .line = line_, .entry = entry_},
          more == 0 ? problem_
                    : fmt::format("{} ({} more {} faults)", problem_, more, more == 1 ? "row has" : "rows have"));
}

CsvReader::CsvReader(LineReader lines, const std::filesystem::path& file, std::span<const std::string_view> expected)
    : lines_(lines), file_(file), has_comments_(!expected.empty()) {
  find_header(expected);
  while (columns_.size() > 1 && columns_.back().empty()) columns_.pop_back();
  if (columns_.empty()) columns_.emplace_back();
}

void CsvReader::find_header(std::span<const std::string_view> expected) {
  HeaderNames header;
  for (LineReader before = lines_; const auto line = lines_.next(); before = lines_) {
    if (has_comments_ && trimmed(*line).empty()) continue;
    const bool comment = has_comments_ && is_comment(*line);
    HeaderNames found = names_in(comment ? comment_text(*line) : *line, expected);
    if (comment && found.expected == 0) continue;
    // If a comment above has expected names and this line has none, this line is a row, and the comment is the header.
    // Otherwise this line is the header.
    const bool is_row = !comment && header.expected > 0 && found.expected == 0;
    if (is_row) {
      lines_ = before;
      break;
    }
    header = std::move(found);
    header_line_ = lines_.line();
    if (!comment) break;
  }
  if (header.expected == 0 && has_comments_) skip_lines_above_header(expected, header);
  columns_ = std::move(header.names);
  separator_ = header.separator;
}

void CsvReader::skip_lines_above_header(std::span<const std::string_view> expected, HeaderNames& header) {
  constexpr int kMaxLines = 20;
  if (header.names.empty() || finite_number(header.names[0]) || has_decimal_comma(header.names[0])) return;
  LineReader lines = lines_;
  std::size_t above = 1;
  for (int i = 0; i < kMaxLines; ++i) {
    const auto line = lines.next();
    if (!line) return;
    if (trimmed(*line).empty() || is_comment(*line)) continue;
    HeaderNames found = names_in(*line, expected);
    if (finite_number(found.names[0]) || has_decimal_comma(found.names[0])) return;
    // Require two expected names, because a title may contain one expected name by chance. If the list `expected` has
    // only one name, this name suffices.
    if (found.expected >= std::min<std::size_t>(2, expected.size())) {
      first_line_above_ = header_line_;
      lines_above_ = above;
      header = std::move(found);
      header_line_ = lines.line();
      lines_ = lines;
      return;
    }
    ++above;
  }
}

std::optional<std::string> CsvReader::note_of_lines_above() const {
  if (lines_above_ == 0) return std::nullopt;
  return fmt::format("line {}: {} above the header {} not used", first_line_above_,
                     lines_above_ == 1 ? "1 line" : fmt::format("{} lines", lines_above_),
                     lines_above_ == 1 ? "is" : "are");
}

void CsvReader::split(std::string_view row) {
  split_cells(row, separator_, cells_);
  drop_trailing_cells(cells_, columns_.size());
}

void CsvReader::find_separator_of_rows(std::string_view row) {
  is_first_row_ = false;
  if (!has_comments_ || has_all_cells() || columns_.size() < 2) return;
  const char of_header = separator_;
  for (const char separator : kSeparators) {
    // Below a header with semicolons or tabs, commas in the rows are more likely decimal commas than separators.
    if (separator == ',' && of_header != ' ') continue;
    separator_ = separator;
    split(row);
    if (has_all_cells() && (finite_number(cells_[0]) || has_decimal_comma(cells_[0]))) return;
  }
  separator_ = of_header;
  split(row);
}

bool CsvReader::advance() {
  auto row = lines_.next();
  while (row && (trimmed(*row).empty() || (has_comments_ && is_comment(*row)))) row = lines_.next();
  if (!row) return false;
  row_ = *row;
  split(row_);
  if (is_first_row_) find_separator_of_rows(row_);
  return true;
}

std::string CsvReader::cell_count_problem() const {
  return fmt::format("got {} cells; allowed: {}{}", cells_.size(), columns_.size(),
                     cause_of_cell_count(row_, separator_, cells_.size(), columns_.size()));
}

bool CsvReader::next() {
  if (!advance()) return false;
  if (!has_all_cells()) fail_in_line(file_, line(), cell_count_problem());
  return true;
}

std::size_t NumberTable::line_of(std::size_t row) const {
  const auto next = std::ranges::upper_bound(line_jumps, row, {}, &std::pair<std::size_t, std::size_t>::first);
  return next == line_jumps.begin() ? row + 1 : std::prev(next)->second + (row - std::prev(next)->first);
}

namespace {

/// Says which columns of a file are copied into a NumberTable. `chosen` has the meaning of NumberTable::chosen.
struct TakenColumns {
  std::vector<std::size_t> cells;  ///< for each column of the table: index of the same column in the file
  std::vector<std::optional<std::size_t>> chosen;
};

/// Returns the part of an error message that names the columns that a file may have.
std::string allowed_columns(std::span<const TableQuantity> quantities) {
  std::vector<std::string> texts;
  for (const TableQuantity& quantity : quantities) {
    std::vector<std::string> names;
    for (const auto& alternative : quantity.alternatives)
      names.push_back(fmt::format("{}", fmt::join(alternative, ",")));
    texts.push_back(fmt::format("{}{}", quantity.is_optional ? "optionally " : "", fmt::join(names, " or ")));
  }
  return fmt::format("the columns {} (in any order, others are ignored)", fmt::join(texts, "; "));
}

void refuse_duplicates(const Words& columns, const std::filesystem::path& file, std::size_t line) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto first = static_cast<std::size_t>(std::ranges::find(columns, columns[i]) - columns.begin());
    if (first < i && !columns[i].empty())
      fail_in_line(file, line,
                   fmt::format("columns {} and {} are both named {}; allowed: each name once", first + 1, i + 1,
                               quoted_token(columns[i])));
  }
}

/// Returns the column names in `alternative` that are missing in the file.
std::vector<std::string_view> missing_names(const std::vector<std::string_view>& alternative, const Words& columns) {
  std::vector<std::string_view> missing;
  std::ranges::copy_if(alternative, std::back_inserter(missing),
                       [&](std::string_view name) { return std::ranges::find(columns, name) == columns.end(); });
  return missing;
}

/// Returns the index of the alternative whose columns the file has. If the file has all columns of no alternative,
/// returns nullopt and appends the names of the missing columns to `missing`. If the quantity is optional and the file
/// has none of its columns, appends no name. Throws InputError if the file has all columns of two alternatives.
std::optional<std::size_t> chosen_alternative(const TableQuantity& quantity, const CsvReader& csv,
                                              const std::filesystem::path& file, std::vector<std::string>& missing) {
  std::optional<std::size_t> chosen;
  std::vector<std::string> absent;  // for each incomplete alternative: the names of its missing columns
  bool has_some = false;
  for (std::size_t i = 0; i < quantity.alternatives.size(); ++i) {
    const auto& alternative = quantity.alternatives[i];
    const auto names = missing_names(alternative, csv.columns());
    if (names.empty() && chosen) {
      fail_in_line(file, csv.header_line(),
                   fmt::format("has the columns {} and the columns {}; allowed: only one of them",
                               fmt::join(quantity.alternatives[*chosen], ","), fmt::join(alternative, ",")));
    }
    if (names.empty()) chosen = i;
    // If the file has a part of an alternative, report only the missing columns of this alternative.
    const bool is_partial = names.size() < alternative.size();
    if (is_partial && !has_some) absent.clear();
    if (is_partial || !has_some) absent.push_back(fmt::format("{}", fmt::join(names, ",")));
    has_some = has_some || is_partial;
  }
  if (!chosen && (has_some || !quantity.is_optional)) missing.push_back(fmt::format("{}", fmt::join(absent, " or ")));
  return chosen;
}

/// Returns a note about the columns of a file that are not read; nothing if all columns are read.
std::optional<std::string> unused_columns(const CsvReader& csv, const TakenColumns& taken) {
  constexpr std::size_t kShown = 10;
  std::vector<std::string> names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < csv.columns().size(); ++i) {
    if (std::ranges::find(taken.cells, i) != taken.cells.end()) continue;
    if (++count <= kShown) names.push_back(fmt::format("{} {}", i + 1, quoted_token(csv.columns()[i])));
  }
  if (count == 0) return std::nullopt;
  if (count > kShown) names.push_back(fmt::format("{} more", count - kShown));
  return fmt::format("line {}: {} {} {} not used", csv.header_line(), count == 1 ? "column" : "columns",
                     fmt::join(names, ", "), count == 1 ? "is" : "are");
}

/// Searches the header of the file for the columns of each quantity. Throws InputError if a required column is missing.
TakenColumns take_columns(const CsvReader& csv, const std::filesystem::path& file,
                          std::span<const TableQuantity> quantities) {
  const Words& columns = csv.columns();
  const std::size_t line = std::max<std::size_t>(csv.header_line(), 1);
  const std::string allowed = allowed_columns(quantities);
  if (finite_number(columns[0]) || has_decimal_comma(columns[0]))
    fail_in_line(file, line, fmt::format("got a row of numbers and no header; allowed: a header with {}", allowed));
  refuse_duplicates(columns, file, line);
  TakenColumns taken;
  std::vector<std::string> missing;
  for (const TableQuantity& quantity : quantities) {
    const auto chosen = chosen_alternative(quantity, csv, file, missing);
    taken.chosen.push_back(chosen);
    if (!chosen) continue;
    for (const std::string_view name : quantity.alternatives[*chosen])
      taken.cells.push_back(static_cast<std::size_t>(std::ranges::find(columns, name) - columns.begin()));
  }
  if (missing.empty()) return taken;
  const std::string header = fmt::format("{}", fmt::join(columns, ","));
  fail_in_line(
      file, line,
      fmt::format("got header {}; missing: {}; allowed: {}", quoted_token(header), fmt::join(missing, "; "), allowed));
}

/// Returns the error message for a cell that is not a number.
std::string cell_problem(const CsvReader& csv, std::size_t cell) {
  const std::string_view text = csv.cells()[cell];
  const std::string lower = lower_case(text);
  std::string cause;
  if (lower.find("nan") != std::string::npos || lower.find("inf") != std::string::npos)
    cause = "; remove the row, or replace the missing value";
  else if (text.find(',') != std::string_view::npos)
    cause = "; write numbers with a decimal point, without decimal commas and separators of thousands";
  else
    cause = cause_of_exponent(text);
  const auto has_digit = [](std::string_view word) { return word.find_first_of("0123456789") != std::string::npos; };
  if (cause.empty() && std::ranges::none_of(csv.cells(), has_digit))
    cause = "; remove the line if it holds names or units";
  return fmt::format("column {} {}: got {}; allowed: a finite number{}", cell + 1, quoted_token(csv.columns()[cell]),
                     quoted_token(text), cause);
}

/// Converts a cell that std::from_chars does not accept: a number with a leading '+' or with a decimal comma. Returns
/// nullopt for any other cell. With `decimal_comma`, the number must have a decimal comma.
std::optional<double> unusual_number(std::string_view cell, bool decimal_comma) {
  if (cell.starts_with('+') && !cell.starts_with("+-")) cell.remove_prefix(1);
  if (!decimal_comma) return finite_number(cell);
  if (!has_decimal_comma(cell)) return std::nullopt;
  std::string number(cell);
  number[number.find(',')] = '.';
  return finite_number(number);
}

/// Reads the rows of a table. With `decimal_comma`, numbers have a decimal comma and no decimal point.
class RowParser {
 public:
  RowParser(CsvReader rows, const TakenColumns& taken, bool decimal_comma)
      : csv_(std::move(rows)), taken_(taken), decimal_comma_(decimal_comma) {}

  /// Appends the rows to the table. At a decimal comma that the parser does not expect, stops and returns the line of
  /// this comma. Returns nothing if all rows were read.
  std::optional<std::size_t> read(NumberTable& table, const std::filesystem::path& file, std::size_t max_rows) {
    std::size_t row = 0, line = 0;  // index of the row, and line of the previous row
    while (csv_.advance()) {
      if (!csv_.has_all_cells()) {
        if (!is_blank_row()) faults_.add(csv_.line(), csv_.cell_count_problem());
        continue;
      }
      if (csv_.cells()[taken_.cells[0]].empty() && is_blank_row()) continue;
      if (csv_.line() != line + 1) table.line_jumps.emplace_back(row, csv_.line());
      line = csv_.line();
      if (!read_row(table)) return csv_.line();
      if (++row > max_rows) fail_in_line(file, csv_.line(), fmt::format("more than {} rows", max_rows));
    }
    faults_.throw_if_any(file);
    return std::nullopt;
  }

 private:
  bool is_blank_row() const { return std::ranges::all_of(csv_.cells(), &std::string_view::empty); }

  /// Appends the numbers of the current row. Returns false at an unexpected decimal comma.
  bool read_row(NumberTable& table) {
    for (const std::size_t index : taken_.cells) {
      const std::string_view cell = csv_.cells()[index];
      const bool mixed = decimal_comma_ && cell.find('.') != std::string_view::npos;
      auto value = mixed ? std::nullopt : finite_number(cell);
      if (!value && !decimal_comma_ && has_decimal_comma(cell)) return false;
      if (!value && !mixed) value = unusual_number(cell, decimal_comma_ && has_decimal_comma(cell));
      if (!value) {
        faults_.add(csv_.line(),
                    cell_problem(csv_, index) + (mixed ? "; other numbers of the file have a decimal comma" : ""));
        table.values.resize(table.values.size() - table.values.size() % taken_.cells.size());
        return true;
      }
      table.values.push_back(*value);
    }
    return true;
  }

  CsvReader csv_;
  const TakenColumns& taken_;
  bool decimal_comma_;
  RowFaults faults_;
};

}  // namespace

NumberTable parse_number_table(std::string_view text, const std::filesystem::path& file,
                               std::span<const TableQuantity> quantities, std::size_t max_rows) {
  if (text.empty())
    fail_in_line(file, 1,
                 fmt::format("the file is empty; allowed: a header with {}, and rows", allowed_columns(quantities)));
  // Find the columns.
  std::vector<std::string_view> expected;
  for (const TableQuantity& quantity : quantities)
    for (const auto& names : quantity.alternatives) expected.insert(expected.end(), names.begin(), names.end());
  const CsvReader csv(LineReader(text), file, expected);
  const TakenColumns taken = take_columns(csv, file, quantities);
  NumberTable table;
  table.columns = taken.cells.size();
  table.chosen = taken.chosen;
  if (auto note = csv.note_of_lines_above()) table.notes.push_back(std::move(*note));
  if (auto note = unused_columns(csv, taken)) table.notes.push_back(std::move(*note));
  // Parse the rows. If a number has a decimal comma, parse all rows again: a number with a point is then a fault.
  if (const auto line = RowParser(csv, taken, false).read(table, file, max_rows)) {
    table.values.clear();
    table.line_jumps.clear();
    table.notes.push_back(fmt::format("line {}: numbers are read with a decimal comma", *line));
    RowParser(csv, taken, true).read(table, file, max_rows);
  }
  if (std::string cut = warning_of_cut_line(text); !cut.empty()) table.notes.push_back(std::move(cut));
  return table;
}

}  // namespace hapbench
