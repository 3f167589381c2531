#include "scenarios/input/installed_folder.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <vector>

#include "scenarios/input/input_error.hpp"

// Path of the share folder, for programs of projects that use find_package: a static library cannot find out where it
// was installed. Defined in .cmake/share_folder.cpp, which these projects link. Null in all other programs.
extern "C" [[gnu::weak]] const char hapbench_share_folder[];

namespace hapbench {

namespace fs = std::filesystem;

namespace {

/// An object in this shared library or program. dladdr finds the file of the library by the address of this object.
constexpr char kHere = 0;

/// Returns the share folder that the build defines, or an empty path.
fs::path build_share_folder() {
#ifdef HAPBENCH_SHARE
  return HAPBENCH_SHARE;
#else
  return hapbench_share_folder != nullptr ? hapbench_share_folder : "";
#endif
}

/// Returns the paths at which the folder may be, in the order of the search.
std::vector<fs::path> candidate_paths(const std::string& name) {
  // Find the files of this library and of the program. They are equal if the library is linked statically.
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error), wanted = fs::path("share") / "hapbench" / name;
  Dl_info object;
  const fs::path library = dladdr(&kHere, &object) != 0 ? fs::canonical(object.dli_fname, error) : program;
  std::vector<fs::path> candidates;
  // A shared library searches near its own file first. The folder of the program, which may be the Python interpreter,
  // may contain files of another version.
  if (library != program)
    for (fs::path above = library.parent_path(); above != above.root_path(); above = above.parent_path())
      candidates.push_back(above / wanted);
  candidates.push_back(program.parent_path().parent_path() / wanted);
  if (const fs::path share = build_share_folder(); !share.empty()) candidates.push_back(share / name);
  return candidates;
}

}  // namespace

fs::path installed_folder(const std::string& name) {
  const std::vector<fs::path> candidates = candidate_paths(name);
  for (const fs::path& candidate : candidates) {
    std::error_code error;
    // The build tree has a symbolic link to the folder in the source tree. The canonical path makes messages name the
    // source tree.
    const fs::path found = fs::canonical(candidate, error);
    if (!error && fs::is_directory(found, error)) return found;
  }
  throw InputError(
      fmt::format("{}: is missing; allowed: the program where it was built or installed, with its folders next to it",
                  candidates.back().string()));
}

}  // namespace hapbench
