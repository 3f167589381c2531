#include "scenarios/batch/result_folders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Returns true if a path from the list stays below the directory when all links but its last part are followed.
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

std::vector<fs::path> paths_in(const Json& json, const char* name) {
  std::vector<fs::path> paths;
  if (!json.is_object() || !json.contains(name) || !json[name].is_array()) return paths;
  for (const Json& path : json[name])
    if (path.is_string()) paths.emplace_back(path.get<std::string>());
  return paths;
}

void write_list(const fs::path& file, const ResultList& list) {
  const auto texts = [](const std::vector<fs::path>& paths) {
    Json json = Json::array();
    for (const fs::path& path : paths) json.push_back(path.generic_string());
    return json;
  };
  write_file_atomically(file, json_text({{"runs", texts(list.runs)}, {"tables", texts(list.tables)}}));
}

/// Removes the empty directories from `path` up to, but not including, `directory`.
void remove_empty(const fs::path& directory, fs::path path) {
  std::error_code error;
  for (; !path.empty(); path = path.parent_path())
    if (!fs::is_directory(directory / path, error) || !fs::remove(directory / path, error) || error) return;
}

bool contains(const std::vector<fs::path>& paths, const fs::path& path) {
  return std::find(paths.begin(), paths.end(), path) != paths.end();
}

/// The list of results that a command left in a directory; empty where there is none or it cannot be read.
ResultList results_on_record(const fs::path& directory) {
  const fs::path file = directory / kResultListFile;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  try {
    const Json json = parse_json(read_text_file(file, kLargestJsonFile));
    return {paths_in(json, "runs"), paths_in(json, "tables")};
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace

void replace_earlier_results(const fs::path& directory, const ResultList& now) {
  const fs::path file = directory / kResultListFile;
  const ResultList earlier = results_on_record(directory);
  std::error_code ignored;
  for (const fs::path& run : earlier.runs) {
    if (contains(now.runs, run) || !lies_below(directory, run)) continue;
    remove_run(directory / run);
    remove_empty(directory, run);
  }
  for (const fs::path& table : earlier.tables) {
    if (!lies_below(directory, table) || !fs::is_regular_file(directory / table, ignored)) continue;
    fs::remove(directory / table, ignored);
    remove_empty(directory, table.parent_path());
  }
  write_list(file, now);
}

void forget_results_if_none(const fs::path& directory) {
  const ResultList list = results_on_record(directory);
  std::error_code ignored;
  const auto is_there = [&](const fs::path& path) {
    return fs::exists(directory / path, ignored) && !fs::is_empty(directory / path, ignored);
  };
  if (std::any_of(list.runs.begin(), list.runs.end(), is_there)) return;
  if (std::any_of(list.tables.begin(), list.tables.end(), is_there)) return;
  fs::remove(directory / kResultListFile, ignored);
}

}  // namespace hapbench
