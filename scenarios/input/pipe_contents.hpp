#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace hapbench {

/// Contents of the pipes that this process has read. A pipe, such as /dev/stdin or <(command) of a shell, gives its
/// bytes only once, but a command may need them several times: to check, to run and to hash. Thread-safe.
class PipeContents {
 public:
  /// Returns the stored contents of a pipe. Returns nullopt if the pipe has been written to since its contents were
  /// stored, if no contents are stored, or if the file is not a pipe.
  std::optional<std::string> find(const std::filesystem::path& file) const;
  /// Stores the contents if the file is a pipe. Called after the file was read to its end.
  void keep(const std::filesystem::path& file, const std::string& contents);

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> contents_;  ///< contents by device, inode and time of the last write
};

/// Returns the instance for this process.
PipeContents& pipe_contents();

/// Returns true for a file under /dev or /proc, such as /dev/stdin or <(command). Relative paths in such a file have no
/// meaning, because the file has no folder of its own.
bool has_no_folder(const std::filesystem::path& file);

}  // namespace hapbench
