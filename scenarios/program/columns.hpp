#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "results/io/table_writer.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/table.hpp"

/// Tables of results: one list of columns gives the CSV file, the JSON, the printed table and what `describe` says.
namespace hapbench {

/// Where a column of a table is.
struct Shown {
  bool csv = true, json = true, printed = false;
  bool wide = false;         ///< printed with --wide only
  std::string heading = {};  ///< above the printed column, in two lines at most; empty: its name
  int digits = 4;            ///< significant ones of a number without a tolerance
};
inline const Shown kOnlyJson = {.csv = false}, kOnlyCsv = {.json = false};
/// Also printed, under a heading; not so when it is empty.
Shown under(std::string heading, int digits = 4, Shown where = {});
/// In no file; nor printed without a name.
Shown only_printed(bool wide = false);
/// Nowhere unless the table has the column.
Shown when(bool has_it, Shown where = {});

/// The cell of a number as it is printed: the digits that its tolerance leaves; "-" for nothing.
std::string printed(const Cell& cell, const Shown& shown, const std::optional<double>& tolerance);

/// A table that `describe` knows; without a file one that is only printed.
struct DescribedTable {
  struct Entry {
    std::string name, unit, meaning;  ///< no unit: text
  };
  std::string file = {}, holds = {};
  std::vector<Entry> columns = {};           ///< of the CSV file
  std::vector<Table::Column> headings = {};  ///< of the printed table
};
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

  /// The printed table, as wide as the layout; `rows`: rows, or references to them.
  template <class Rows>
  std::string text(const Rows& rows, const Layout& layout) const {
    Table table{headings(layout.in_full())};
    for (const Row& row : rows) {
      std::vector<std::string> cells;
      for (const Entry& entry : entries_) {
        if (!entry.is_printed(layout.in_full())) continue;
        cells.push_back(printed(entry.cell(row), entry.shown, entry.tolerance ? entry.tolerance(row) : std::nullopt));
      }
      table.rows.push_back(std::move(cells));
    }
    return table.text(layout.width());
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

}  // namespace hapbench
