#pragma once

#include <filesystem>
#include <system_error>
#include <vector>

namespace hapbench {

/// Creates directories for results, and in the end removes those that are still empty, as failed work leaves them.
class NewDirectories {
 public:
  NewDirectories() = default;
  ~NewDirectories();
  NewDirectories(const NewDirectories&) = delete;
  NewDirectories& operator=(const NewDirectories&) = delete;

  /// Creates a directory and its missing parents; as std::filesystem::create_directories.
  std::error_code create(const std::filesystem::path& directory);

 private:
  std::vector<std::filesystem::path> made_;  ///< parents first
};

}  // namespace hapbench
