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

/// Error in writing a result file. The message contains the failed operation, the file and the reason.
class IoError : public std::runtime_error {
 public:
  /// `attempt` completes "cannot …", for example "write".
  IoError(const std::string& attempt, const std::filesystem::path& path, const std::error_code& reason)
      : std::runtime_error("cannot " + attempt + " " + path.string() + ": " + reason.message()) {}
};

class FileSet;

/// A file that appears under its final name either complete or not at all. Bytes go to a hidden temporary file in the
/// same directory, .NAME.tmp, which `commit` renames. The temporary file is locked (flock) while it is open, so a
/// second writer gets an error. The next writer overwrites a temporary file that a killed process left. Not safe
/// against a power failure: fsync would cost milliseconds for each of the thousands of files of a sweep, and a sweep
/// can be computed again.
class AtomicFile {
 public:
  /// Opens the temporary file. Precondition: the directory exists. Throws IoError, also if another writer has the
  /// file open.
  explicit AtomicFile(std::filesystem::path target);
  /// If `commit` was not called: removes the temporary file and leaves an existing target unchanged.
  ~AtomicFile();
  AtomicFile(AtomicFile&& other) = default;
  AtomicFile& operator=(AtomicFile&&) = delete;

  /// Appends bytes through a buffer. Allocates nothing. After an error, drops all bytes; `commit` throws the first
  /// error.
  void append(std::string_view bytes) noexcept;

  /// Completes the file and renames it, which replaces an existing target. If an earlier write failed (such as on a
  /// full disk), removes the temporary file and throws IoError with the first error. If `together` is not null, instead
  /// only moves the file to this set; FileSet::commit then completes and renames the file. Call once, after the last
  /// `append`.
  void commit(FileSet* together = nullptr);

 private:
  friend FileSet;

  /// Writes the buffered bytes, so that only the renaming can still fail. Throws IoError like `commit`.
  void complete();
  /// Removes the temporary file and throws the first error. Does nothing if there was no error.
  void throw_error();
  void rename();
  void discard() noexcept;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::unique_ptr<char[]> buffer_;  ///< stdio buffer of file_
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, std::fclose};
  std::error_code error_;
};

/// A set of files that replace their earlier versions together: if one file cannot be written, all earlier versions
/// stay. Renaming a file takes microseconds. If the process is killed between the first and the last renaming, a
/// mixture of old and new files remains. The file added last, such as a summary, is renamed last, so its presence shows
/// that the set is complete.
class FileSet {
 public:
  /// Adds a file, which gets its final name in `commit`.
  void take(AtomicFile file) { files_.push_back(std::move(file)); }
  /// Adds a file with these contents. Throws IoError.
  void write(const std::filesystem::path& target, std::string_view contents) {
    files_.emplace_back(target).append(contents);
  }
  /// Marks an existing file for removal in `commit`: after all files are complete and before the first is renamed.
  void remove(std::filesystem::path file) { removed_.push_back(std::move(file)); }
  /// Completes all files, removes the marked files and renames the files in the order in which they were added. Throws
  /// IoError. Call once, after the last file was added.
  void commit();

 private:
  std::vector<AtomicFile> files_;
  std::vector<std::filesystem::path> removed_;
};

/// Writes a file with these contents through AtomicFile. Throws IoError.
void write_file_atomically(const std::filesystem::path& target, std::string_view contents);

}  // namespace hapbench
