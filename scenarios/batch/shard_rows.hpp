#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "scenarios/batch/shard.hpp"

namespace hapbench {

/// What the table of a shard says of itself.
struct ShardTitle {
  std::filesystem::path file;
  Shard shard;
  std::size_t runs = 0;    ///< of the whole sweep
  std::string definition;  ///< of the sweep
  std::string header;      ///< line without its end
};

/// The line in front of a shard's table.
std::string title_line(const Shard& shard, std::size_t runs, std::string_view definition);

/// Reads the table of a shard row by row, in pieces: the memory it takes does not depend on the table, and the file is
/// open only while a piece is read, so that there may be more shards than a process may have files open.
class ShardRows {
 public:
  /// Reads title and header. `piece` is how much is read at a time [bytes]; longer lines are read all the same. Throws
  /// InputError that names file and line.
  explicit ShardRows(std::filesystem::path file, std::size_t piece = std::size_t{1} << 16);

  const ShardTitle& title() const { return title_; }
  /// The next row, valid until the next call; none behind the last one of the shard. Throws InputError that names file
  /// and line for a row that is not the next of the shard, has more or fewer cells than the header, or is missing.
  std::optional<std::string_view> next();

 private:
  /// The next line without its end; none at the end of the file.
  std::optional<std::string_view> line();
  bool read_piece();
  void read_title(std::string_view line);

  ShardTitle title_;
  std::size_t piece_;
  std::string text_;           ///< what has been read and not given
  std::size_t given_ = 0;      ///< of the text
  std::uintmax_t offset_ = 0;  ///< in the file, behind the text
  std::size_t lines_ = 0;      ///< given
  std::size_t columns_ = 0;
  std::size_t run_ = 0;  ///< of the next row
};

}  // namespace hapbench
