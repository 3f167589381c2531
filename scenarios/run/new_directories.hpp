#pragma once

#include <filesystem>
#include <system_error>
#include <vector>

namespace hapbench {

/// Creates directories for results. The destructor removes the created directories that are still empty, so
/// that failed work leaves no empty directories.
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
  std::vector<std::filesystem::path> created_;  ///< created directories, parents first
};

}  // namespace hapbench
