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

/// A table with a row for each case, which grows row by row and can be resumed.
namespace hapbench {

/// The file of a table, its columns, and the JSON next to it, whose "definition" is equal for equal tables.
struct TableTitle {
  std::filesystem::path file;
  std::string header;     ///< line without its end; the first column is the number of the case
  Json about;             ///< written beside the table as NAME.json
  std::size_t cases = 0;  ///< rows have numbers below
};

/// A table with a row for each case. It grows as FILE.part, with its JSON next to it, a row at a time and in any order,
/// so that a killed process loses only the cases that were under way. When it is whole its rows are put in order and
/// both files get their names. Memory: 8 bytes a case while they are put in order, before that a bit.
class TableFile {
 public:
  /// Whether a row that was written before stays; one that does not is written again. May throw.
  using Keep = std::function<bool(std::size_t i, std::string_view row)>;

  /// Begins a table, over another one that was under way. With `keep`, goes on with it, or with a finished one: a torn
  /// last line is dropped. Throws InputError where a table that is under way would lose its rows without `keep`, or is
  /// another one or damaged with it, and IoError.
  explicit TableFile(TableTitle title, const Keep& keep = {});

  /// Rows of a table that is under way.
  static std::size_t rows_under_way(const std::filesystem::path& file);

  /// Which cases have a row.
  const std::vector<bool>& rows() const { return has_; }
  std::size_t count() const { return static_cast<std::size_t>(std::count(has_.begin(), has_.end(), true)); }
  /// Other processes see the row when this returns. Throws IoError. Precondition: it is one line.
  void add(std::size_t i, std::string_view row);
  /// Puts the rows in order, by number; of two of one case the later stays. Throws IoError.
  void finish();

 private:
  bool is_of_this_definition() const;
  void resume(const Keep& keep);
  void append(const std::string& text);

  TableTitle title_;
  std::filesystem::path part_, about_part_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> out_;
  std::vector<bool> has_;
};

/// Gives the table its rows, those of these files in the order of their numbers, of two of one case the later, and its
/// JSON. Returns their number; when it is not `rows`, writes nothing. Throws InputError for other tables, and IoError.
std::size_t put_in_order(const TableTitle& title, const std::vector<std::filesystem::path>& parts, std::size_t rows);

}  // namespace hapbench
