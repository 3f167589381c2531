#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "results/io/io_error.hpp"

namespace hapbench {

/// The rows of a sweep that is under way, on disk as they come, so that a killed sweep can go on where it was.
///
/// A text file: the first line names the sweep, each further line is a row behind its checksum. A row is on disk, as
/// far as other processes can see, when `add` returns; a power cut may take the last ones. What is torn or damaged, and
/// everything behind it, does not count. The file is locked (flock) while the journal lives.
class Journal {
 public:
  /// With `resume` reads the rows that a journal of the same `sweep` holds; none when there is no file. Without it, or
  /// when not even the first line is complete, begins anew. Throws InputError for a journal of another sweep or one
  /// that another process writes, IoError when it cannot be written.
  Journal(std::filesystem::path file, const std::string& sweep, bool resume);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// True for a file that begins as the journal of this work does.
  static bool is_of(const std::filesystem::path& file, const std::string& sweep);

  /// The rows found, in the order in which they were added.
  const std::vector<std::string>& rows() const { return rows_; }
  const std::filesystem::path& file() const { return file_; }
  /// Precondition: a row is one line. Throws IoError.
  void add(std::string_view row);
  /// Removes the file: the sweep is complete.
  void remove() noexcept;

 private:
  void read(const std::string& first_line);
  void write(std::string_view text);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::vector<std::string> rows_;
};

}  // namespace hapbench
