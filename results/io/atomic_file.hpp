#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

#include "results/io/io_error.hpp"

namespace hapbench {

/// A file that appears under its final name complete or not at all.
///
/// Bytes go to the hidden temporary ".<name>.<pid>.tmp" in the same directory; `commit` gives it its name. The
/// temporary is locked (flock) for as long as it is written, so that remove_stale_temporaries can tell the leavings of
/// a killed run from the work of a living one, in another container or on another host too, where process numbers mean
/// nothing.
///
/// Safe against a killed process, not against a power cut: fsync would cost milliseconds for each of the thousands of
/// files of a sweep, whose rows can be computed again.
///
/// One writer per target at a time; a second one in the same process is refused.
class AtomicFile {
 public:
  /// Opens the temporary. The directory must exist. Throws IoError.
  explicit AtomicFile(std::filesystem::path target);
  /// Without `commit`: removes the temporary, leaves what is at the target.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Adds bytes through a buffer of fixed size. Allocates nothing. The first error is kept for `commit`; bytes after it
  /// are dropped.
  void append(std::string_view bytes) noexcept;

  /// Writes what is left and renames; an existing target is replaced. Throws IoError for the first error since the
  /// beginning (a full disk, say), and then leaves nothing behind. Call once, last.
  void commit();

  /// False after the first error.
  bool good() const noexcept { return !error_; }
  const std::filesystem::path& target() const noexcept { return target_; }

 private:
  void flush() noexcept;
  void discard() noexcept;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::unique_ptr<char[]> buffer_;
  std::size_t used_ = 0;
  int descriptor_ = -1;
  std::error_code error_;
};

/// The whole contents at once. Throws IoError.
void write_file_atomically(const std::filesystem::path& target, std::string_view contents);

}  // namespace hapbench
