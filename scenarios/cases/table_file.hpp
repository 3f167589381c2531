#pragma once

#include <cstdio>
#include <memory>

#include "scenarios/cases/cases.hpp"

namespace hapbench {

/// The cells of a line, without their quotes and a carriage return at its end.
std::vector<std::string> csv_cells(std::string_view line);

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
  std::size_t count() const { return count_; }
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
  std::size_t count_ = 0;
};

/// The file of a sweep, sweep.csv, or of one of its shards, sweep.0_of_4.csv.
std::string table_name(const std::optional<Shard>& shard);

/// Joins the tables of all shards that are in a folder into sweep.csv. False when there are none, or not all beside a
/// whole table. Throws InputError for tables that are damaged, incomplete or not of one definition, and IoError.
bool join_shards(const std::filesystem::path& folder);

}  // namespace hapbench
