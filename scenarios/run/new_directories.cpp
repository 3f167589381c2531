#include "scenarios/run/new_directories.hpp"

namespace hapbench {

namespace fs = std::filesystem;

std::error_code NewDirectories::create(const fs::path& directory) {
  constexpr int kMaxAttempts = 1000;
  std::error_code error;
  // Another process may remove a new parent directory that is still empty, before its child is created. Then the
  // creation of the child fails, and the next attempt creates both again.
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    error = create_missing(directory);
    if (error != std::errc::no_such_file_or_directory) break;
  }
  return error;
}

/// Creates the missing directories of a path once, and records the directories that this call created.
std::error_code NewDirectories::create_missing(const fs::path& directory) {
  std::vector<fs::path> missing;
  std::error_code error, unknown;
  // Find the missing directories, innermost first.
  for (fs::path path = directory; !path.empty() && path != path.root_path() && !fs::exists(path, unknown);
       path = path.parent_path()) {
    missing.push_back(path);
  }
  for (auto path = missing.rbegin(); path != missing.rend(); ++path) {
    // If the path ends with a slash, `missing` has the last directory twice. create_directory() then returns false the
    // second time, and the directory is recorded once.
    if (fs::create_directory(*path, error)) created_.push_back(*path);
    if (error) return error;
  }
  fs::create_directories(directory, error);  // sets an error if a file has this name
  return error;
}

NewDirectories::~NewDirectories() {
  std::error_code not_empty;
  for (auto path = created_.rbegin(); path != created_.rend(); ++path) fs::remove(*path, not_empty);
}

}  // namespace hapbench
