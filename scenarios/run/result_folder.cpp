#include "scenarios/run/result_folder.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/target_metrics.hpp"
#include "scenarios/scene/trials.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr const char *kTrialDirectory = "subject_", *kEffectiveFile = "scenario.effective.json";

/// Creates a directory. Throws IoError.
void create(NewDirectories& directories, const fs::path& directory) {
  if (const auto error = directories.create(directory)) throw IoError("create", directory, error);
}

/// Returns the subdirectories of trials in a directory of results.
std::vector<fs::path> trial_directories(const fs::path& directory) {
  std::error_code ignored;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(directory, ignored))
    if (entry.is_directory(ignored) && entry.path().filename().string().starts_with(kTrialDirectory))
      found.push_back(entry.path());
  return found;
}

/// Marks the files of an earlier run for removal (FileSet::remove). A run with other settings may not write all of
/// these files, so it would not overwrite them.
void remove_earlier_run(const fs::path& directory, FileSet& files) {
  for (const char* name : {"summary.json", "columns.json", kTargetTable.file, "timing.json"})
    files.remove(directory / name);
  for (const ResultTable& table : record_tables()) files.remove(directory / table.file);
  for (const fs::path& trial : trial_directories(directory)) remove_earlier_run(trial, files);
}

/// Removes the trial directories that are empty, because this run does not use them. fs::remove() keeps directories
/// that contain files.
void remove_empty_trials(const fs::path& directory) {
  std::error_code ignored;
  for (const fs::path& trial : trial_directories(directory)) fs::remove(trial, ignored);
}

}  // namespace

ResultFolder::ResultFolder(const RunOutput& output) : directory_(output.directory) {
  create(directories_, directory_);
  if (!output.is_locked) lock_.emplace(directories_, directory_, kRunFiles, "run");
}

fs::path ResultFolder::trial_directory(Trial trial, std::size_t trials) {
  if (trials == 1) return directory_;
  fs::path directory = directory_ / fmt::format("{}{}_trial_{}", kTrialDirectory, trial.subject, trial.number);
  create(directories_, directory);
  return directory;
}

bool ResultFolder::write(const RecordFields& record, const Json& effective, const Result& result,
                         const Recorders& recorders) {
  // Replace the tables.
  std::vector<ResultTable> tables = tables_with(record);
  FileSet files;
  remove_earlier_run(directory_, files);
  for (const auto& recorder : recorders) recorder->finish(&files);
  if (result.sections.contains("targets")) {
    tables.push_back(kTargetTable);
    write_target_table(directory_ / kTargetTable.file, result.targets, &files);
  }
  // Write the descriptions of the run.
  const auto add = [&](const char* name, const std::string& text) { files.write(directory_ / name, text); };
  const std::string text = json_text(effective);
  add(kEffectiveFile, text);
  std::ifstream earlier(directory_ / kEffectiveFile, std::ios::binary);
  const std::string before{std::istreambuf_iterator<char>(earlier), {}};
  add("columns.json", json_text(columns_json(tables, result.metrics)));
  if (record.timing) add("timing.json", timing_text(result));
  // Write the summary last and remove the earlier summary first, because a summary marks the directory as a complete
  // run.
  add("summary.json", json_text(summary_json(result)));
  files.commit();
  remove_empty_trials(directory_);
  return !before.empty() && before != text;
}

void remove_run(const fs::path& directory) {
  std::error_code ignored;
  if (!fs::is_directory(directory, ignored)) return;
  FileSet files;
  remove_earlier_run(directory, files);
  files.remove(directory / kEffectiveFile);
  files.commit();
  remove_empty_trials(directory);
}

}  // namespace hapbench
