#include "scenarios/program/results_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "scenarios/input/input_error.hpp"
#include "scenarios/program/output.hpp"

namespace hapbench {

void require_writable_directory(ProgramContext& context, const std::filesystem::path& directory,
                                const std::string& option) {
  const auto refuse = [&](const std::string& problem) {
    fail_in({.about_options = {option}}, fmt::format("{} {}: {}", option, directory.string(), problem));
  };
  if (const auto error = context.directories.create(directory)) refuse("cannot be created: " + error.message());
  if (!std::filesystem::is_directory(directory)) refuse("is not a directory");
  if (access(directory.c_str(), W_OK | X_OK) != 0) refuse("cannot be written to");
}

FolderLock locked_results(ProgramContext& context, const std::filesystem::path& directory, const std::string& set,
                          const std::string& writer, const std::string& option) {
  require_writable_directory(context, directory, option);
  FolderLock lock(context.directories, directory, set, writer);
  if (!lock.problem().empty()) {
    print_note(context, fmt::format("{}: the file system cannot lock files ({}); do not start another {} with this "
                                    "folder before this command has ended",
                                    directory.string(), lock.problem(), writer));
  }
  return lock;
}

/// Throws IoError if `directory` is thesis/SCENARIO in a folder that a running `reproduce` has locked. Other folders
/// beside thesis, such as the folders of studies, are allowed.
static void require_not_of_reproduce(const std::filesystem::path& directory) {
  std::error_code ignored;
  const std::filesystem::path parent = std::filesystem::weakly_canonical(directory, ignored).parent_path();
  if (parent.filename() == "thesis" && FolderLock::is_held(parent.parent_path(), kReproduceFiles))
    FolderLock::refuse(parent.parent_path(), kReproduceFiles);
}

FolderLock locked_run(ProgramContext& context, const std::filesystem::path& directory) {
  constexpr int kCompareLevels = 3;  // levels of folders: SCENARIO/ALGORITHM/seed_K
  FolderLock lock = locked_results(context, directory, kRunFiles, "run");
  require_unlocked_parents(directory, kCompareFiles, kCompareLevels);
  require_not_of_reproduce(directory);
  return lock;
}

void require_unlocked(const std::vector<std::filesystem::path>& folders, const std::string& set) {
  // A command in an inner folder that starts at the same time finds the caller's lock and gives up. Wait until it has
  // given up, so that one of the two commands succeeds.
  using namespace std::chrono_literals;
  constexpr int kMaxAttempts = 50;
  for (const std::filesystem::path& folder : folders) {
    for (int attempt = 0; FolderLock::is_held(folder, set); ++attempt) {
      if (attempt == kMaxAttempts) FolderLock::refuse(folder, set);
      std::this_thread::sleep_for(10ms);
    }
  }
}

std::filesystem::path results_directory(const std::string& out, const std::string& name) {
  return out.empty() ? std::filesystem::path("results") / "out" / name : std::filesystem::path(out);
}

}  // namespace hapbench
