#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "results/io/table_writer.hpp"
#include "scenarios/program/command.hpp"
#include "sim/core/math.hpp"

/// What a command answers: text as wide as the terminal, and tables, of which one list of columns gives the CSV file,
/// the JSON, the printed table and what `describe` says.
namespace hapbench {

// ---- Text

/// The width of standard output [characters]: COLUMNS of the environment, else that of the terminal; unbounded in a
/// pipe or a file, and when `output_in_full`.
std::size_t output_width();
/// The option --wide.
inline bool& output_in_full() {
  static bool in_full = false;
  return in_full;
}
/// The width of prose: that of the output, but at most 100.
inline std::size_t prose_width() {
  return std::min<std::size_t>(output_width(), 100);
}

/// Breaks lines wider than the output at blanks, never within a word; continuations are indented by two more blanks.
std::string fitted(std::string_view text, std::size_t width = output_width());

/// The text in bold where the stream is a terminal, unless NO_COLOR is set or TERM is "dumb".
std::string bold(std::FILE* stream, std::string_view text);

/// A table for the terminal: columns as wide as their widest cell, a rule under the header. Numbers are aligned right,
/// text left. A title may have two lines.
struct Table {
  struct Column {
    std::string title;
    bool number = true;        ///< aligned as one
    std::string meaning = {};  ///< for `describe`: a name that it knows or a sentence; empty: it knows the title itself
  };
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows = {};  ///< a cell for each column

  /// The table in at most `most_width` characters: a last column of text is wrapped; other columns that do not fit
  /// follow below, in blocks that each begin with the first column.
  std::string text(std::size_t most_width = output_width()) const;
};

/// Prose of at most `width` characters a line, each behind `indent` blanks; line breaks stay.
std::string wrapped(std::string_view text, std::size_t indent = 2, std::size_t width = prose_width());

/// A name behind `indent` blanks with its meaning beside it, from `column` on, or below it where the name is too long.
std::string entry(std::string_view name, std::string_view meaning, std::size_t indent = 2, std::size_t column = 26,
                  std::size_t width = prose_width());

/// A number with `digits` significant digits; "-" for NaN and infinities.
inline std::string significant(double value, int digits = 4) {
  return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : "-";
}
/// How many of `most` significant digits a tolerance leaves a number, one at least: down to its own leading one.
inline int deserved_digits(double value, const std::optional<double>& tolerance, int most) {
  if (!tolerance || !(*tolerance > 0.0) || value == 0.0 || !std::isfinite(value)) return most;
  const double digits = std::floor(math::log10(std::abs(value))) - std::floor(math::log10(*tolerance)) + 1.0;
  return static_cast<int>(std::clamp(digits, 1.0, static_cast<double>(most)));
}
/// A number with the digits that its tolerance (> 0) leaves it: down to the tolerance's leading one, and without an
/// exponent above 1e-4. `digits` significant ones where no tolerance is known, or it is larger than the number.
inline std::string deserved(double value, const std::optional<double>& tolerance, int digits = 4) {
  const double size = std::abs(value);
  if (!tolerance || !(*tolerance > 0.0 && *tolerance < size) || !std::isfinite(size)) return significant(value, digits);
  const int last = static_cast<int>(std::floor(math::log10(*tolerance)));
  if (size < 1e-4 || last < -12) return significant(value, deserved_digits(value, tolerance, 12));
  const double unit = math::pow(10.0, last);
  return last < 0 ? fmt::format("{:.{}f}", value, -last) : fmt::format("{:.0f}", std::round(value / unit) * unit);
}

// ---- Tables in files, JSON and terminal

/// Where a column of a table is.
struct Shown {
  bool csv = true, json = true, printed = false;
  bool wide = false;         ///< printed with --wide only
  std::string heading = {};  ///< above the printed column, in two lines at most; empty: its name
  int digits = 4;            ///< significant ones of a number without a tolerance
};
inline const Shown kOnlyJson = {.csv = false}, kOnlyCsv = {.json = false};
/// Also printed, under a heading; not so when it is empty.
inline Shown under(std::string heading, int digits = 4, Shown where = {}) {
  where.printed = !heading.empty();
  where.heading = std::move(heading);
  where.digits = digits;
  return where;
}
/// In no file; nor printed without a name.
inline Shown only_printed(bool wide = false) {
  return {.csv = false, .json = false, .printed = true, .wide = wide};
}
/// Nowhere unless the table has the column.
inline Shown when(bool has_it, Shown where = {}) {
  return has_it ? std::move(where) : Shown{.csv = false, .json = false};
}

/// The cell of a number as it is printed: the digits that its tolerance leaves; "-" for nothing.
inline std::string printed(const Cell& cell, const Shown& shown, const std::optional<double>& tolerance) {
  if (const auto* number = std::get_if<double>(&cell)) return deserved(*number, tolerance, shown.digits);
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return std::to_string(*count);
  if (const auto* yes = std::get_if<bool>(&cell)) return *yes ? "yes" : "no";
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return "-";
}

/// A table that `describe` knows; without a file one that is only printed.
struct DescribedTable {
  struct Entry {
    std::string name, unit, meaning;  ///< no unit: text
  };
  std::string file = {}, holds = {};
  std::vector<Entry> columns = {};           ///< of the CSV file
  std::vector<Table::Column> headings = {};  ///< of the printed table
};
/// Those of single commands, from the columns that these write and print.
using CommandTables = std::vector<DescribedTable>();
CommandTables claim_tables, converge_tables, league_tables, limit_tables, run_tables, single_run_tables, stress_tables,
    sweep_tables, tune_tables;

/// The columns of a table with rows of type `Row`: those that are always there, and those that depend on the question.
template <class Row>
class Columns {
 public:
  struct Entry : DescribedTable::Entry {
    /// `get`: what a row has in the column, as a function of the row or a member of it (cell_of).
    template <class Get>
    Entry(std::string its_name, std::string its_unit, std::string its_meaning, Get get, Shown where = {},
          std::function<std::optional<double>(const Row&)> its_tolerance = {})
        : DescribedTable::Entry{std::move(its_name), std::move(its_unit), std::move(its_meaning)},
          cell([get](const Row& row) { return cell_of(std::invoke(get, row)); }),
          shown(std::move(where)),
          tolerance(std::move(its_tolerance)) {}

    std::function<Cell(const Row&)> cell;
    Shown shown;
    std::function<std::optional<double>(const Row&)> tolerance;  ///< by how much the number may be wrong

    const std::string& title() const { return shown.heading.empty() ? name : shown.heading; }
    bool is_printed(bool in_full) const { return shown.printed && !title().empty() && (in_full || !shown.wide); }
  };

  Columns(std::initializer_list<Entry> entries = {}) : entries_(entries) {}
  void add(const Columns& more) { entries_.insert(entries_.end(), more.entries_.begin(), more.entries_.end()); }

  void write(const std::filesystem::path& file, std::span<const Row> rows, FileSet& files) const {
    std::string header;
    for (const Entry& entry : entries_)
      if (entry.shown.csv) header += (header.empty() ? "" : ",") + entry.name;
    CsvWriter csv(file, header);
    std::vector<Cell> cells;
    for (const Row& row : rows) {
      cells.clear();
      for (const Entry& entry : entries_)
        if (entry.shown.csv) cells.push_back(entry.cell(row));
      csv.cells(cells);
    }
    csv.finish(&files);
  }

  Json json(const Row& row) const {
    Json object = Json::object();
    for (const Entry& entry : entries_)
      if (entry.shown.json) object[entry.name] = cell_json(entry.cell(row));
    return object;
  }
  Json json_list(std::span<const Row> rows) const {
    Json list = Json::array();
    for (const Row& row : rows) list.push_back(json(row));
    return list;
  }

  /// As wide as the output is to be; `rows`: rows, or references to them.
  template <class Rows>
  Table table(const Rows& rows) const {
    Table table{headings(output_in_full())};
    for (const Row& row : rows) {
      std::vector<std::string> cells;
      for (const Entry& entry : entries_) {
        if (!entry.is_printed(output_in_full())) continue;
        cells.push_back(printed(entry.cell(row), entry.shown, entry.tolerance ? entry.tolerance(row) : std::nullopt));
      }
      table.rows.push_back(std::move(cells));
    }
    return table;
  }

  std::vector<Table::Column> headings(bool in_full = true) const {
    std::vector<Table::Column> headings;
    for (const Entry& entry : entries_)
      if (entry.is_printed(in_full))
        headings.push_back({entry.title(), !entry.unit.empty(), entry.shown.csv ? entry.name : entry.meaning});
    return headings;
  }

  DescribedTable described(std::string file = {}, std::string holds = {}) const {
    DescribedTable table{std::move(file), std::move(holds), {}, headings()};
    for (const Entry& entry : entries_)
      if (entry.shown.csv) table.columns.push_back(entry);
    return table;
  }

 private:
  std::vector<Entry> entries_;
};

/// Collects an answer, and gives it at once: its files all together, then what is printed, or its JSON.
class Report {
 public:
  Report(const OutputOptions& output, std::filesystem::path folder) : output_(output), folder_(std::move(folder)) {}
  /// Into the folder of --out, or results/out/`name`. Throws InputError unless it can be written to.
  Report(const CommonOptions& options, const std::string& name)
      : Report(options.output, results_directory(options.out, name)) {
    require_writable_directory(folder_);
  }

  const std::filesystem::path& folder() const { return folder_; }
  void say(std::string_view text) { text_ += text; }
  template <class Row>
  void write(const std::filesystem::path& file, const Columns<Row>& columns, const std::vector<Row>& rows) {
    columns.write(folder_ / file, rows, files_);
  }
  FileSet& files() { return files_; }
  Json& json() { return json_; }
  /// A row that failed, or whose answer is bad: the text is printed as an error, and becomes the exit status.
  void fault(const std::string& text, int status) {
    faults_.push_back(text);
    status_ = status;
  }
  /// The exit status. Throws IoError.
  int finish() {
    files_.commit();
    for (const std::string& fault : faults_) print_error(fault);
    print(output_, text_, json_);
    return status_;
  }

 private:
  const OutputOptions& output_;
  std::filesystem::path folder_;
  FileSet files_;
  std::string text_;
  Json json_;
  std::vector<std::string> faults_;
  int status_ = kSuccess;
};

}  // namespace hapbench
