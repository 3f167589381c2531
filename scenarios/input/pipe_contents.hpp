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
  /// Returns the contents of a pipe that was read before, if it has not been written to since. Returns nothing for
  /// every other file.
  std::optional<std::string> find(const std::filesystem::path& file) const;
  /// Keeps the contents if the file is a pipe. Called after it was read to its end.
  void keep(const std::filesystem::path& file, const std::string& contents);

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> contents_;  ///< contents by device, inode and time of the last write
};

/// Returns the contents of the pipes of this process.
PipeContents& pipe_contents();

/// Returns true for a file without a folder of its own: /dev/stdin, <(command) and other files of /dev and /proc.
/// Relative paths in such a file have no meaning.
bool has_no_folder(const std::filesystem::path& file);

}  // namespace hapbench
