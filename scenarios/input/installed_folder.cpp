#include "scenarios/input/installed_folder.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <vector>

#include "scenarios/input/input_error.hpp"

// A static library does not know where it was installed. Users of find_package link .cmake/share_folder.cpp instead.
extern "C" [[gnu::weak]] const char hapbench_share_folder[];

namespace hapbench {

namespace fs = std::filesystem;

namespace {

/// An address in this shared object or program, for dladdr.
constexpr char kHere = 0;

/// The share folder that the build defines; may be empty.
fs::path build_share_folder() {
#ifdef HAPBENCH_SHARE
  return HAPBENCH_SHARE;
#else
  return hapbench_share_folder != nullptr ? hapbench_share_folder : "";
#endif
}

/// The paths at which the folder is looked for, in this order.
std::vector<fs::path> candidate_paths(const std::string& name) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error), wanted = fs::path("share") / "hapbench" / name;
  Dl_info object;
  const fs::path library = dladdr(&kHere, &object) != 0 ? fs::canonical(object.dli_fname, error) : program;
  std::vector<fs::path> places;
  // A library knows its own: the interpreter that loads it may lie beside another version's.
  if (library != program)
    for (fs::path above = library.parent_path(); above != above.root_path(); above = above.parent_path())
      places.push_back(above / wanted);
  places.push_back(program.parent_path().parent_path() / wanted);
  if (const fs::path share = build_share_folder(); !share.empty()) places.push_back(share / name);
  return places;
}

}  // namespace

fs::path installed_folder(const std::string& name) {
  const std::vector<fs::path> places = candidate_paths(name);
  for (const fs::path& place : places) {
    std::error_code error;
    // Canonical, so that messages name a folder of the source tree instead of the build tree's link to it.
    const fs::path found = fs::canonical(place, error);
    if (!error && fs::is_directory(found, error)) return found;
  }
  throw InputError(
      fmt::format("{}: is missing; allowed: the program where it was built or installed, with its folders next to it",
                  places.back().string()));
}

}  // namespace hapbench
