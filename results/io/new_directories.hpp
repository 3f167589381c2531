#pragma once

#include <filesystem>
#include <system_error>
#include <vector>

namespace hapbench {

/// Makes directories for results, and removes those of them that are still empty when it goes, so that work which was
/// stopped or failed leaves none behind.
class NewDirectories {
 public:
  NewDirectories() = default;
  ~NewDirectories();
  NewDirectories(const NewDirectories&) = delete;
  NewDirectories& operator=(const NewDirectories&) = delete;

  /// Makes a directory and its missing parents; `error` as of std::filesystem::create_directories.
  void create(const std::filesystem::path& directory, std::error_code& error);

 private:
  std::vector<std::filesystem::path> made_;  ///< parents first
};

}  // namespace hapbench
