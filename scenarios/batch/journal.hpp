#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

#include "results/io/atomic_file.hpp"

namespace hapbench {

/// The rows of a sweep that is under way. They are written to disk as they come, so that a killed sweep can be resumed,
/// and are not kept in memory.
///
/// A text file: the first line names the sweep, each further line is a row after its checksum. Other processes can see
/// a row when `flush` returns; a power failure may lose the last ones. The first torn or damaged row and everything
/// after it is ignored. The file is locked (flock) while the journal lives.
class Journal {
 public:
  /// Offset of a row in the file; never 0.
  using Place = std::uint64_t;
  using Found = std::function<void(Place place, std::string_view row)>;

  /// With `resume`, calls `found` for the rows in a journal of the same `sweep`, in the order in which they were added;
  /// does not call it when there is no file. Without `resume`, or when not even the first line is complete, starts a
  /// new journal. Throws InputError for a journal of another sweep or one that another process writes, and IoError when
  /// the file cannot be written.
  Journal(std::filesystem::path file, const std::string& sweep, bool resume, const Found& found = {});
  /// Flushes pending rows; ignores I/O errors.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Returns true for a file that begins like a journal of this sweep.
  static bool is_of(const std::filesystem::path& file, const std::string& sweep);
  /// Returns true while a process writes the journal, if the file system supports locks.
  static bool is_being_written(const std::filesystem::path& file);
  /// Number of rows, damaged ones included.
  static std::size_t count_rows(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  /// Keeps a row until the next flush. Precondition: it is one line.
  Place add(std::string_view row);
  /// Writes the rows added since the last flush. Throws IoError.
  void flush();
  /// Calls `found` for every row that has been flushed, in the order in which they were added.
  void read_rows(const Found& found) const;
  /// Reads a row from the file. Precondition: it has been flushed. Throws IoError.
  std::string row_at(Place place);
  /// Removes the file: the sweep is complete.
  void remove() noexcept;

 private:
  void resume(const std::string& first_line, const Found& found);

  std::filesystem::path file_;
  int descriptor_ = -1;
  Place end_ = 0;  ///< size of what is written [bytes]
  std::string unwritten_;
  std::ifstream reader_;  ///< of row_at
};

}  // namespace hapbench
