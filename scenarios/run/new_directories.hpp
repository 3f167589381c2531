#pragma once

#include <filesystem>
#include <system_error>
#include <vector>

namespace hapbench {

/// Creates directories for results. The destructor removes the created directories that are still empty, so
/// that failed work leaves no empty directories. A directory that another process has locked (folder_lock.hpp) is not
/// empty and stays, because it contains the file of the lock.
class NewDirectories {
 public:
  NewDirectories() = default;
  ~NewDirectories();
  NewDirectories(const NewDirectories&) = delete;
  NewDirectories& operator=(const NewDirectories&) = delete;

  /// Creates a directory and its missing parents, like std::filesystem::create_directories(), and returns its
  /// error code.
  std::error_code create(const std::filesystem::path& directory);

 private:
  std::error_code create_missing(const std::filesystem::path& directory);

  std::vector<std::filesystem::path> created_;  ///< created directories, parents first
};

}  // namespace hapbench
