#include "scenarios/batch/result_folders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/result_folder.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Returns true if a path stays below the directory when all links but its last part are followed.
bool lies_below(const fs::path& directory, const fs::path& path) {
  if (path.empty() || path.is_absolute()) return false;
  std::error_code error;
  const fs::path root = fs::canonical(directory, error);
  if (error) return false;
  const fs::path parent = fs::weakly_canonical(root / path.parent_path(), error);
  if (error || path.filename() == ".." || path.filename() == "." || path.filename().empty()) return false;
  return std::mismatch(root.begin(), root.end(), parent.begin(), parent.end()).first == root.end() &&
         !fs::is_symlink(fs::symlink_status(root / path, error));
}

/// The paths that a command listed under a name, without those that lead elsewhere; none where the list cannot be read.
std::vector<fs::path> listed(const fs::path& directory, const char* name) {
  std::vector<fs::path> paths;
  try {
    const Json list = parse_json(read_text_file(directory / kResultListFile, kLargestJsonFile)).at(name);
    if (!list.is_array()) return {};
    for (const Json& path : list)
      if (path.is_string() && lies_below(directory, path.get<std::string>()))
        paths.emplace_back(path.get<std::string>());
  } catch (const std::exception&) {
    paths.clear();
  }
  return paths;
}

Json texts_of(const std::vector<fs::path>& paths) {
  Json texts = Json::array();
  for (const fs::path& path : paths) texts.push_back(path.generic_string());
  return texts;
}

/// Removes the empty directories from `path` up to, but not including, `directory`.
void remove_empty(const fs::path& directory, fs::path path) {
  std::error_code error;
  for (; !path.empty(); path = path.parent_path())
    if (!fs::is_directory(directory / path, error) || !fs::remove(directory / path, error) || error) return;
}

}  // namespace

void replace_earlier_results(const fs::path& directory, const ResultList& now) {
  for (const fs::path& run : listed(directory, "runs")) {
    if (std::ranges::find(now.runs, run) != now.runs.end()) continue;
    remove_run(directory / run);
    remove_empty(directory, run);
  }
  std::error_code ignored;
  for (const fs::path& table : listed(directory, "tables")) {
    if (!fs::is_regular_file(directory / table, ignored)) continue;
    fs::remove(directory / table, ignored);
    remove_empty(directory, table.parent_path());
  }
  write_file_atomically(directory / kResultListFile,
                        json_text({{"runs", texts_of(now.runs)}, {"tables", texts_of(now.tables)}}));
}

void forget_results_if_none(const fs::path& directory) {
  std::error_code ignored;
  for (const char* name : {"runs", "tables"}) {
    for (const fs::path& path : listed(directory, name))
      if (fs::exists(directory / path, ignored) && !fs::is_empty(directory / path, ignored)) return;
  }
  fs::remove(directory / kResultListFile, ignored);
}

}  // namespace hapbench
