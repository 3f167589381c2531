#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "results/io/table_writer.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/table.hpp"

/// Tables of results. One list of columns generates the CSV file, the JSON, the printed table and the descriptions that
/// `describe` prints.
namespace hapbench {

/// The outputs that include a column of a table.
struct Shown {
  bool csv = true, json = true, printed = false;
  bool wide = false;         ///< true if the column is printed only with --wide
  std::string heading = {};  ///< heading of the printed column, at most two lines; empty: the name of the column
  int digits = 4;            ///< significant digits of a number without a tolerance
  /// True for the column of a varied field, that is, of a field to which the command gives several values. Its numbers
  /// are printed with enough digits to distinguish the rows.
  bool varied = false;
  Rounding rounding = Rounding::nearest;  ///< of numbers in the printed table
};
inline const Shown kOnlyJson = {.csv = false}, kOnlyCsv = {.json = false};
/// Returns `where`, changed so that the column is also printed, under `heading` and with `digits` significant digits.
/// With an empty heading the column is not printed.
Shown under(std::string heading, int digits = 4, Shown where = {});
/// Returns the outputs of a column that is in no CSV file and not in the JSON. The column is printed unless its heading
/// and its name are both empty. `wide`: true if it is printed only with --wide.
Shown only_printed(bool wide = false);
/// Returns `where` if `has_it` is true. Otherwise returns the outputs of a column that appears nowhere.
Shown when(bool has_it, Shown where = {});

/// Returns `where` with numbers of the printed table rounded down or up.
Shown rounded(Rounding rounding, Shown where);

/// Returns `where` with `varied` set to true: the column has the values of a varied field.
Shown varied(Shown where);

/// Returns the value of a varied field as a cell: a number if the text is a finite number, otherwise the text.
Cell axis_cell(const std::string& value);

/// Returns the cells of a column as text. A number has the digits that are significant at its tolerance, or
/// `shown.digits` digits without a tolerance. An empty cell is "-". In the column of a varied field, whole numbers and
/// numbers of at most six digits are printed exactly. The other numbers in this column have four to six digits: the
/// smallest number of digits with which different numbers have different texts. `tolerances` has an entry for each
/// cell.
std::vector<std::string> printed(std::span<const Cell> cells, const Shown& shown,
                                 std::span<const std::optional<double>> tolerances);

/// A table that `describe` explains. `file` is empty for a table that is only printed. `holds` describes the rows of
/// the table.
struct DescribedTable {
  struct Entry {
    std::string name, unit, meaning;  ///< an empty unit marks text
  };
  std::string file = {}, holds = {};
  std::vector<Entry> columns = {};           ///< columns of the CSV file
  std::vector<Table::Column> headings = {};  ///< columns of the printed table
  std::vector<Entry> json_only = {};         ///< members of a row in the JSON that are no columns of the CSV file
};
/// The columns of a table with rows of type `Row`: fixed columns, and columns that depend on the command's
/// options.
template <class Row>
class Columns {
 public:
  struct Entry : DescribedTable::Entry {
    /// `get` returns the value of a row in this column: a function of the row, or a pointer to a member of the
    /// row. cell_of() converts the value into a cell.
    template <class Get>
    Entry(std::string its_name, std::string its_unit, std::string its_meaning, Get get, Shown where = {},
          std::function<std::optional<double>(const Row&)> its_tolerance = {})
        : DescribedTable::Entry{std::move(its_name), std::move(its_unit), std::move(its_meaning)},
          cell([get](const Row& row) { return cell_of(std::invoke(get, row)); }),
          shown(std::move(where)),
          tolerance(std::move(its_tolerance)) {}

    std::function<Cell(const Row&)> cell;
    Shown shown;
    std::function<std::optional<double>(const Row&)> tolerance;  ///< largest error of a row's number; empty if unknown

    const std::string& title() const { return shown.heading.empty() ? name : shown.heading; }
    bool is_printed(bool in_full) const { return shown.printed && !title().empty() && (in_full || !shown.wide); }
  };

  Columns(std::initializer_list<Entry> entries = {}) : entries_(entries) {}
  void add(const Columns& more) { entries_.insert(entries_.end(), more.entries_.begin(), more.entries_.end()); }

  /// Writes the columns with Shown::csv to a CSV file, and adds the file to `files`.
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

  /// Returns a row as a JSON object, with a member for each column with Shown::json.
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

  /// Returns the printed table. `rows` contains rows or references to rows. `in_full`: true to include the columns that
  /// are printed only with --wide.
  template <class Rows>
  Table table(const Rows& rows, std::string caption, bool in_full) const {
    Table table{headings(in_full), {}, std::move(caption)};
    table.rows.resize(std::size(rows));
    for (const Entry& entry : entries_) {
      if (!entry.is_printed(in_full)) continue;
      std::vector<Cell> cells;
      std::vector<std::optional<double>> tolerances;
      for (const Row& row : rows) {
        cells.push_back(entry.cell(row));
        tolerances.push_back(entry.tolerance ? entry.tolerance(row) : std::nullopt);
      }
      const std::vector<std::string> texts = printed(cells, entry.shown, tolerances);
      for (std::size_t i = 0; i < texts.size(); ++i) table.rows[i].push_back(texts[i]);
    }
    return table;
  }

  /// Returns the printed table as text, with lines of at most the layout's width.
  template <class Rows>
  std::string text(const Rows& rows, const Layout& layout) const {
    return table(rows, "", layout.in_full()).text(layout.width());
  }

  /// Returns the columns of the printed table. `in_full`: true to include the columns that are printed only with
  /// --wide.
  std::vector<Table::Column> headings(bool in_full = true) const {
    std::vector<Table::Column> headings;
    for (const Entry& entry : entries_)
      if (entry.is_printed(in_full))
        headings.push_back({entry.title(), !entry.unit.empty(), entry.shown.csv ? entry.name : entry.meaning,
                            entry.unit.starts_with("unit of") ? "" : entry.unit});
    return headings;
  }

  /// Returns the table as `describe` explains it, with all columns of the CSV file, all printed columns and all further
  /// members of the JSON.
  DescribedTable described(std::string file = {}, std::string holds = {}) const {
    DescribedTable table{std::move(file), std::move(holds), {}, headings()};
    for (const Entry& entry : entries_) {
      if (entry.shown.csv)
        table.columns.push_back(entry);
      else if (entry.shown.json)
        table.json_only.push_back(entry);
    }
    return table;
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace hapbench
