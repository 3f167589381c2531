#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "results/io/atomic_file.hpp"

namespace hapbench {

/// The rows of a sweep that is under way, on disk as they come, so that a killed sweep can go on where it was, and in
/// no other place, so that memory does not grow with them.
///
/// A text file: the first line names the sweep, each further line is a row behind its checksum. A row is on disk, as
/// far as other processes can see, when `flush` returns; a power cut may take the last ones. What is torn or damaged,
/// and everything behind it, does not count. The file is locked (flock) while the journal lives.
class Journal {
 public:
  /// Where a row is in the file; never 0.
  using Place = std::uint64_t;
  using Found = std::function<void(Place place, std::string_view row)>;

  /// With `resume` calls `found` for the rows that a journal of the same `sweep` holds, in the order in which they were
  /// added; none when there is no file. Without it, or when not even the first line is complete, begins anew. Throws
  /// InputError for a journal of another sweep or one that another process writes, IoError when it cannot be written.
  Journal(std::filesystem::path file, const std::string& sweep, bool resume, const Found& found = {});
  /// Writes what has not been, if it can be.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// True for a file that begins as the journal of this work does.
  static bool is_of(const std::filesystem::path& file, const std::string& sweep);
  /// True while a process writes the journal, as far as the file system has locks.
  static bool is_being_written(const std::filesystem::path& file);
  /// Number of rows, whole or not.
  static std::size_t count_rows(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  /// Keeps a row until the next flush. Precondition: it is one line.
  Place add(std::string_view row);
  /// Writes the rows added since the last time. Throws IoError.
  void flush();
  /// A row, read from the file. Precondition: it has been written. Throws IoError.
  std::string row_at(Place place) const;
  /// Removes the file: the sweep is complete.
  void remove() noexcept;

 private:
  void read(const std::string& first_line, const Found& found);

  std::filesystem::path file_;
  int descriptor_ = -1;
  Place end_ = 0;  ///< of what is written
  std::string unwritten_;
};

}  // namespace hapbench
