#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace hapbench {

/// A result file could not be written. The message says what was tried, on which file, and why it failed.
class IoError : public std::runtime_error {
 public:
  /// `attempt` completes "cannot …", e.g. "write".
  IoError(const std::string& attempt, const std::filesystem::path& path, const std::error_code& reason)
      : std::runtime_error("cannot " + attempt + " " + path.string() + ": " + reason.message()) {}
};

class FileSet;

/// A file that appears under its final name complete or not at all: bytes go to a hidden temporary beside it,
/// .NAME.tmp, which `commit` gives the final name. It is locked (flock) while it is written: a second writer is
/// refused. What a killed process left is overwritten by the next writer. Not safe against a power cut: fsync would
/// cost milliseconds for each of the thousands of files of a sweep, whose rows can be computed again.
class AtomicFile {
 public:
  /// Opens the temporary. The directory must exist. Throws IoError, also when the file is being written.
  explicit AtomicFile(std::filesystem::path target);
  /// Without `commit`: removes the temporary, leaves what is at the target.
  ~AtomicFile();
  AtomicFile(AtomicFile&& other) = default;
  AtomicFile& operator=(AtomicFile&&) = delete;

  /// Adds bytes through a buffer. Allocates nothing. Keeps the first error for `commit` and drops bytes after it.
  void append(std::string_view bytes) noexcept;

  /// Completes the file and renames it, which replaces an existing target, or leaves that to a set of files. Throws
  /// IoError for the first error so far (a full disk, say), and then leaves nothing behind. Call once, last.
  void commit(FileSet* together = nullptr);

 private:
  friend FileSet;

  /// Writes what is left, so that nothing but the renaming can fail any more. Throws IoError as `commit` does.
  void complete();
  void throw_error();
  void rename();
  void discard() noexcept;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::unique_ptr<char[]> buffer_;  ///< of the file
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, std::fclose};
  std::error_code error_;
};

/// Files that replace earlier ones together: when one of them cannot be written, all earlier ones stay. A killed
/// process leaves a mixture if it dies between the first and the last renaming, which takes microseconds a file; the
/// file that was taken last, such as a summary, tells then, since it is the last to come.
class FileSet {
 public:
  /// The file gets its final name with the others.
  void take(AtomicFile file) { files_.push_back(std::move(file)); }
  /// The whole contents of a file. Throws IoError.
  void write(const std::filesystem::path& target, std::string_view contents) {
    files_.emplace_back(target).append(contents);
  }
  /// The file, if there is one, goes when the others are complete and before any comes; they come in the order taken.
  void remove(std::filesystem::path file) { removed_.push_back(std::move(file)); }
  /// Throws IoError. Call once, last.
  void commit();

 private:
  std::vector<AtomicFile> files_;
  std::vector<std::filesystem::path> removed_;
};

/// The whole contents at once. Throws IoError.
void write_file_atomically(const std::filesystem::path& target, std::string_view contents);

}  // namespace hapbench
