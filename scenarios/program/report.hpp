#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "results/io/table_writer.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"

/// What a command answers: prose and tables. One list of columns a table gives its CSV file, the JSON, the printed
/// table and what `describe` says of it.
namespace hapbench {

/// Where a column of a table is.
struct Shown {
  bool csv = true, json = true;
  /// Above the printed column, in two lines at most; empty: it is not printed.
  std::string heading = {};
  int digits = 4;     ///< significant ones of a number without a tolerance
  bool wide = false;  ///< printed with --wide only
};

/// Columns that are not everywhere.
inline Shown only_json() {
  return {false, true};
}
inline Shown only_csv() {
  return {true, false};
}

/// The cell of a number, a count, a truth, a text, one of them that need not exist, or of what is a cell already.
template <class Value>
Cell cell_of(const Value& value) {
  if constexpr (requires { value.has_value(); }) {
    return value ? cell_of(*value) : Cell();
  } else if constexpr (std::is_convertible_v<Value, std::string_view>) {
    return std::string(std::string_view(value));
  } else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
    return static_cast<std::uint64_t>(value);
  } else {
    return value;
  }
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
    std::string name, unit, meaning;
  };
  std::string file = {}, holds = {};
  std::vector<Entry> columns = {};           ///< of the CSV file
  std::vector<Table::Column> headings = {};  ///< of the printed table
};

/// The columns of a table with rows of type `Row`: those known when the program is written, and those that depend on
/// the question, such as the fields that vary.
template <class Row>
class Columns {
 public:
  struct Entry {
    std::string name, unit, meaning;
    std::function<Cell(const Row&)> cell;
    Shown shown = {};
    std::function<std::optional<double>(const Row&)> tolerance = {};  ///< by how much the number may be wrong
  };

  /// `get`: what a row has in the column, as a function of the row or a member of it (cell_of).
  template <class Get>
  void add(std::string name, std::string unit, std::string meaning, Get get, Shown shown = {},
           std::function<std::optional<double>(const Row&)> tolerance = {}) {
    const auto cell = [get = std::move(get)](const Row& row) { return cell_of(std::invoke(get, row)); };
    entries_.push_back(
        {std::move(name), std::move(unit), std::move(meaning), cell, std::move(shown), std::move(tolerance)});
  }
  /// A column that is in no file; `unit` is empty for text.
  template <class Get>
  void print(std::string heading, std::string unit, std::string meaning, Get get, bool wide = false) {
    add("", std::move(unit), std::move(meaning), std::move(get),
        {.csv = false, .json = false, .heading = std::move(heading), .wide = wide});
  }

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
    for (const Entry& entry : entries_) {
      if (entry.shown.json) object[entry.name] = cell_json(entry.cell(row));
    }
    return object;
  }

  /// As wide as the output is to be; `rows`: rows, or references to them.
  template <class Rows>
  Table table(const Rows& rows) const {
    Table table(headings(output_is_in_full()));
    for (const Row& row : rows) {
      std::vector<std::string> cells;
      for (const Entry& entry : entries_) {
        if (entry.shown.heading.empty() || (entry.shown.wide && !output_is_in_full())) continue;
        cells.push_back(printed(entry.cell(row), entry.shown, entry.tolerance ? entry.tolerance(row) : std::nullopt));
      }
      table.add(std::move(cells));
    }
    return table;
  }

  std::vector<Table::Column> headings(bool wide = true) const {
    std::vector<Table::Column> headings;
    for (const Entry& entry : entries_) {
      if (!entry.shown.heading.empty() && (wide || !entry.shown.wide))
        headings.push_back({entry.shown.heading, !entry.unit.empty(), entry.shown.csv ? entry.name : entry.meaning});
    }
    return headings;
  }

  DescribedTable described(std::string file = {}, std::string holds = {}) const {
    DescribedTable table{std::move(file), std::move(holds), {}, headings()};
    for (const Entry& entry : entries_)
      if (entry.shown.csv) table.columns.push_back({entry.name, entry.unit, entry.meaning});
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
