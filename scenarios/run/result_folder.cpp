#include "scenarios/run/run_scenario.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <string_view>

#include "algorithms/laws/force_law.hpp"
#include "results/io/columns.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/scene/trials.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

RowSource ratios(const RecordedTrial& t) {
  const auto& asked = t.fields.ratio_iterations;
  constexpr auto start = [](ContactBuffer& contacts) noexcept { return shape_weights(contacts, 0); };
  return ratio_rows({asked.begin(), asked.end()}, {start, update_shaped_weights}, t.contact_capacity);
}

struct RecorderEntry {
  const ResultTable& table;
  std::function<bool(const RecordFields&)> is_wanted;
  RowSource (*rows)(const RecordedTrial& trial);
  bool has_every_row = false;  ///< which rows there are, says the source
};

// The observers that a table is made from are there: the same fields ask for them, and checked() has refused a
// reference that is not measured.
const RecorderEntry kRecorders[] = {
    {kTrajectoryTable, &RecordFields::trajectory,
     [](const RecordedTrial& t) { return trajectory_rows(t.fields, t.inside); }},
    {kContactTable, &RecordFields::contacts, [](const RecordedTrial&) { return contact_rows(); }},
    {kContactTraceTable, &RecordFields::contacts, [](const RecordedTrial&) { return contact_trace_rows(); }},
    {kStiffnessTable, &RecordFields::stiffness_tensor, [](const RecordedTrial&) { return stiffness_rows(); }},
    {kRatioTable, [](const RecordFields& f) { return !f.ratio_iterations.empty(); }, ratios},
    {kEnergyTable, &RecordFields::energy,
     [](const RecordedTrial& t) { return energy_rows(*t.sections.find<EnergyLedger>()); }},
    {kIdealTrajectoryTable, &RecordFields::ideal_trajectory,
     [](const RecordedTrial& t) { return ideal_trajectory_rows(*t.sections.find<IdealTrajectoryObserver>()); }, true},
    {kForceReferenceTable, &RecordFields::force_reference,
     [](const RecordedTrial& t) { return force_reference_rows(*t.sections.find<ForceFidelityObserver>()); }}};

/// The tables that a run with these fields writes.
std::vector<ResultTable> tables_with(const RecordFields& fields) {
  std::vector<ResultTable> tables;
  for (const RecorderEntry& entry : kRecorders) {
    if (!entry.is_wanted(fields)) continue;
    tables.push_back(entry.table);
    if (&entry.table == &kTrajectoryTable) tables.back().columns = trajectory_rows(fields).columns;
  }
  return tables;
}

constexpr double kBytesOfANumber = 12.0;  // between a zero and seventeen digits
constexpr double kContactsOfARow = 30.0;

double lines_a_row(const ResultTable& table, const RecordFields& record) {
  const std::string_view file = table.file;
  if (file == "contacts.csv" || file == "contact_trace.csv") return kContactsOfARow;
  return file == "ratios.csv" ? static_cast<double>(record.ratio_iterations.size()) : 1.0;
}

constexpr const char *kTrialDirectory = "subject_", *kEffectiveFile = "scenario.effective.json";

void create(NewDirectories& directories, const fs::path& directory) {
  if (const auto error = directories.create(directory)) throw IoError("create", directory, error);
}

std::vector<fs::path> trial_directories(const fs::path& directory) {
  std::error_code ignored;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(directory, ignored))
    if (entry.is_directory(ignored) && entry.path().filename().string().starts_with(kTrialDirectory))
      found.push_back(entry.path());
  return found;
}

/// Removes optional files that an earlier run with other settings may have left: they would not belong to this run.
void remove_earlier_run(const fs::path& directory, FileSet& files) {
  for (const char* name : {"summary.json", "columns.json", kTargetTable.file, "timing.json"})
    files.remove(directory / name);
  for (const ResultTable& table : record_tables()) files.remove(directory / table.file);
  for (const fs::path& trial : trial_directories(directory)) remove_earlier_run(trial, files);
}

/// Those that this run has not written to, unless somebody keeps other files there.
void remove_empty_trials(const fs::path& directory) {
  std::error_code ignored;
  for (const fs::path& trial : trial_directories(directory)) fs::remove(trial, ignored);
}

}  // namespace

Recorders make_recorders(const RecordedTrial& trial, const RecordTarget& target) {
  Recorders recorders;
  for (const RecorderEntry& entry : kRecorders) {
    if (!entry.is_wanted(trial.fields)) continue;
    RowSource rows = entry.rows(trial);
    const auto place = [&]() -> TableTarget {
      if (const auto* directory = std::get_if<fs::path>(&target)) return *directory / entry.table.file;
      return &std::get<RecordedTables*>(target)->try_emplace(entry.table.file, rows.columns).first->second;
    }();
    const auto every = static_cast<std::uint64_t>(entry.has_every_row ? 1 : trial.fields.every);
    recorders.push_back(std::make_unique<Recorder>(place, std::move(rows), every));
  }
  return recorders;
}

std::vector<ResultTable> record_tables() {
  std::vector<ResultTable> tables;
  for (const RecorderEntry& entry : kRecorders) tables.push_back(entry.table);
  return tables;
}

double expected_output_bytes(const Scenario& scenario) {
  const RecordFields& record = scenario.record;
  double row = 0.0;
  for (const ResultTable& table : tables_with(record))
    row += lines_a_row(table, record) * kBytesOfANumber * static_cast<double>(table.columns.size());
  const double rows = std::ceil(static_cast<double>(scenario.time.steps) / static_cast<double>(record.every));
  return trial_count(scenario.hand) * rows * row;
}

std::error_code NewDirectories::create(const fs::path& directory) {
  std::vector<fs::path> missing;
  std::error_code error, unknown;
  for (fs::path path = directory; !path.empty() && path != path.root_path() && !fs::exists(path, unknown);
       path = path.parent_path()) {
    missing.push_back(path);
  }
  made_.insert(made_.end(), missing.rbegin(), missing.rend());
  fs::create_directories(directory, error);
  return error;
}

NewDirectories::~NewDirectories() {
  std::error_code not_empty;
  for (auto path = made_.rbegin(); path != made_.rend(); ++path) fs::remove(*path, not_empty);
}

ResultFolder::ResultFolder(const fs::path& directory) : directory_(directory) {
  create(directories_, directory);
  const int descriptor = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  lock_ = {nullptr, [descriptor](void*) { ::close(descriptor); }};
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  throw IoError("write, because another run writes to", directory,
                std::make_error_code(std::errc::device_or_resource_busy));
}

fs::path ResultFolder::of_trial(Trial trial, std::size_t trials) {
  if (trials == 1) return directory_;
  fs::path directory = directory_ / fmt::format("{}{}_trial_{}", kTrialDirectory, trial.subject, trial.number);
  create(directories_, directory);
  return directory;
}

bool ResultFolder::write(const RecordFields& record, const Json& effective, const Result& result,
                         const Recorders& recorders) {
  std::vector<ResultTable> tables = tables_with(record);
  FileSet files;
  remove_earlier_run(directory_, files);
  for (const auto& recorder : recorders) recorder->finish(&files);
  if (result.sections.contains("targets")) {
    tables.push_back(kTargetTable);
    write_target_table(directory_ / kTargetTable.file, result.targets, &files);
  }
  const auto add = [&](const char* name, const std::string& text) { files.write(directory_ / name, text); };
  const std::string text = json_text(effective);
  add(kEffectiveFile, text);
  std::ifstream earlier(directory_ / kEffectiveFile, std::ios::binary);
  const std::string before{std::istreambuf_iterator<char>(earlier), {}};
  add("columns.json", json_text(columns_json(tables, result.metrics)));
  if (record.timing) add("timing.json", timing_text(result));
  // The summary, which says that a run is there, is the first to go and the last to come.
  add("summary.json", json_text(summary_json(result)));
  files.commit();
  remove_empty_trials(directory_);
  return !before.empty() && before != text;
}

void RunTables::write(const Json& of_scenario, const Result& result, const Recorders& recorders) {
  effective = of_scenario;
  for (const auto& recorder : recorders) recorder->finish();
  if (result.sections.contains("targets")) write_target_table(&targets.emplace(kTargetTable.columns), result.targets);
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
