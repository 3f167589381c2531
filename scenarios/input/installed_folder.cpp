#include "scenarios/input/installed_folder.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <optional>

#include "scenarios/input/input_error.hpp"

// A static library does not know where it was installed. Users of find_package link .cmake/share_folder.cpp instead.
extern "C" [[gnu::weak]] const char hapbench_share_folder[];

namespace hapbench {

namespace fs = std::filesystem;

namespace {

/// An address in this shared object or program, for dladdr.
constexpr char kHere = 0;

/// The path is canonical, so that messages name a folder of the source tree instead of the build tree's link to it.
std::optional<fs::path> folder_at(const fs::path& path) {
  std::error_code error;
  const fs::path found = fs::canonical(path, error);
  if (error || !fs::is_directory(found, error)) return std::nullopt;
  return found;
}

std::optional<fs::path> folder_above_shared_object(const fs::path& program, const fs::path& wanted) {
  Dl_info object;
  if (dladdr(&kHere, &object) == 0) return std::nullopt;
  std::error_code error;
  const fs::path file = fs::canonical(object.dli_fname, error);
  if (error || file == program) return std::nullopt;
  for (fs::path above = file.parent_path(); above != above.root_path(); above = above.parent_path())
    if (auto found = folder_at(above / wanted)) return found;
  return std::nullopt;
}

/// The share folder that the build defines; may be empty.
fs::path share_of_build() {
#ifdef HAPBENCH_SHARE
  return HAPBENCH_SHARE;
#else
  return hapbench_share_folder != nullptr ? hapbench_share_folder : "";
#endif
}

}  // namespace

fs::path installed_folder(const std::string& name) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path wanted = fs::path("share") / "hapbench" / name;
  const fs::path beside = program.parent_path().parent_path() / wanted;
  // A library knows its own: the interpreter that loads it may lie beside another version's.
  if (auto found = folder_above_shared_object(program, wanted)) return *found;
  if (auto found = folder_at(beside)) return *found;
  const fs::path share = share_of_build();
  if (!share.empty()) {
    if (auto found = folder_at(share / name)) return *found;
  }
  throw InputError(
      fmt::format("{}: is missing; allowed: the program where it was built or installed, with its folders beside it",
                  (share.empty() ? beside : share / name).string()));
}

}  // namespace hapbench
