#include "scenarios/input/installed_folder.hpp"

#include <fmt/format.h>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

namespace fs = std::filesystem;

fs::path installed_folder(const std::string& name) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path folder = program.parent_path().parent_path() / "share" / "hapbench" / name;
  // Canonical, so that messages name the place in the source tree to which a build tree has links.
  const fs::path found = fs::canonical(folder, error);
  if (!error && fs::is_directory(found, error)) return found;
  throw InputError(
      fmt::format("{}: is missing; allowed: the program where it was built or installed, with its folders beside it",
                  folder.string()));
}

}  // namespace hapbench
