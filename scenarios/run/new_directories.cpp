#include "scenarios/run/new_directories.hpp"

namespace hapbench {

namespace fs = std::filesystem;

std::error_code NewDirectories::create(const fs::path& directory) {
  std::vector<fs::path> missing;
  std::error_code error, unknown;
  // Find the missing parents, innermost first.
  for (fs::path path = directory; !path.empty() && path != path.root_path() && !fs::exists(path, unknown);
       path = path.parent_path()) {
    missing.push_back(path);
  }
  created_.insert(created_.end(), missing.rbegin(), missing.rend());
  fs::create_directories(directory, error);
  return error;
}

NewDirectories::~NewDirectories() {
  std::error_code not_empty;
  for (auto path = created_.rbegin(); path != created_.rend(); ++path) fs::remove(*path, not_empty);
}

}  // namespace hapbench
