#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// A table with a row for each case. The table is written row by row, and an interrupted table can be continued.
namespace hapbench {

/// File, columns and description of a table. Tables of the same sweep have the same "definition" in the description.
struct TableTitle {
  std::filesystem::path file;
  std::string header;     ///< header line without newline; the first column is the number of the case
  Json about;             ///< description, written next to the table as NAME.json
  std::size_t cases = 0;  ///< number of cases; a row number is smaller than this
};

/// A table with a row for each case. Rows are appended to FILE.part, one at a time and in any order, with the
/// JSON file next to it. A killed process therefore loses only unfinished cases. When the table is complete,
/// finish() sorts its rows and gives both files their final names. Memory: one bit for each case; 8 bytes for
/// each case while the rows are sorted.
class TableFile {
 public:
  /// Returns true if a row that was written earlier can be kept. A row that is not kept must be written again.
  /// May throw.
  using Keep = std::function<bool(std::size_t i, std::string_view row)>;

  /// Starts a table.
  /// - Without `keep`, replaces an unfinished table that has no rows. Throws InputError if the unfinished table has
  ///   rows, whether they belong to the same sweep or to another sweep.
  /// - With `keep`, continues an unfinished or finished table, and drops an incomplete last line. Throws
  ///   InputError if the table is damaged or belongs to another sweep.
  /// Throws IoError.
  explicit TableFile(TableTitle title, const Keep& keep = {});

  /// Returns the number of rows in FILE.part, the unfinished table of `file`; 0 if FILE.part does not exist.
  static std::size_t rows_in_progress(const std::filesystem::path& file);

  /// For each case: true if it has a row.
  const std::vector<bool>& rows() const { return has_; }
  std::size_t count() const { return static_cast<std::size_t>(std::count(has_.begin(), has_.end(), true)); }
  /// Appends the row of case i. Other processes can read the row when this function returns. Throws IoError.
  /// Precondition: `row` is a single line.
  void add(std::size_t i, std::string_view row);
  /// Sorts the rows by case number and completes the table. If a case has two rows, the later row is kept.
  /// Throws IoError.
  void finish();

 private:
  bool has_same_definition() const;
  void resume(const Keep& keep);
  void append(const std::string& text);

  TableTitle title_;
  std::filesystem::path part_, about_part_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> out_;
  std::vector<bool> has_;
};

/// Writes the rows of several files into a single table, sorted by case number, and its JSON file. If a case has two
/// rows, the later row is kept. Returns the number of cases with a row. If this number differs from `rows`, writes
/// nothing. Throws InputError for files of other tables, and IoError.
std::size_t write_sorted_table(const TableTitle& title, const std::vector<std::filesystem::path>& parts,
                               std::size_t rows);

}  // namespace hapbench
