#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/slurm.hpp"
#include "scenarios/program/sweep.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

fs::path table_of(const fs::path& directory, const std::optional<Shard>& shard) {
  return directory / (stem_of(shard) + ".csv");
}

fs::path journal_of(const fs::path& directory, const std::optional<Shard>& shard) {
  return directory / (stem_of(shard) + ".journal");
}

fs::path jobs_file(const fs::path& directory) {
  return directory / "sweep_slurm.json";
}

void write_jobs(const fs::path& directory, const SlurmJobs& jobs) {
  write_file_atomically(jobs_file(directory), json_text({{"definition", jobs.definition},
                                                         {"runs", jobs.runs},
                                                         {"shards", jobs.shards},
                                                         {"array", jobs.array},
                                                         {"merge", jobs.merge}}));
}

/// The last submission from this directory, or none. Throws InputError.
std::optional<SlurmJobs> read_jobs(const fs::path& directory) {
  const fs::path file = jobs_file(directory);
  if (std::error_code ignored; !fs::exists(file, ignored)) return std::nullopt;
  try {
    const Json json = parse_json(read_text_file(file, kLargestJsonFile));
    return SlurmJobs{.definition = json.at("definition"),
                     .runs = json.at("runs"),
                     .shards = json.at("shards"),
                     .array = json.at("array"),
                     .merge = json.at("merge"),
                     .text = ""};
  } catch (const Json::exception&) {
    fail_in_file(file, "is not what \"hapbench sweep --slurm\" writes");
  } catch (const InputError& error) {
    fail_in_file(file, error.what());
  }
}

/// The shards of an array's tasks that are in Slurm's queue, and whether each is running. Empty where Slurm does not
/// know the job any more, or is not installed.
std::vector<std::pair<std::size_t, bool>> queued_tasks(const std::string& array) {
  std::vector<std::pair<std::size_t, bool>> tasks;
  if (array.empty()) return tasks;
  const ProgramOutput output = output_of({"squeue", "--noheader", "--array", "--jobs=" + array, "--format=%K %T"});
  LineReader lines(output.text);
  while (const auto line = lines.next()) {
    const Words words = words_of(*line);
    const auto shard = words.size() == 2 ? whole_number(words[0]) : std::nullopt;
    if (output.status == 0 && shard) tasks.emplace_back(*shard, words[1] != "PENDING");
  }
  return tasks;
}

/// The shards without a table. Refuses files of another sweep, which a merge would refuse too.
std::vector<std::size_t> missing_shards(const SweepPlan& plan, const SlurmOptions& options, bool keep_runs,
                                        const fs::path& directory) {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < options.shards; ++i) {
    const Shard shard{i, options.shards};
    const fs::path table = table_of(directory, shard), journal = journal_of(directory, shard);
    const bool is_done = fs::exists(table), is_begun = fs::exists(journal);
    if ((is_done && ShardRows(table).title().definition != plan.definition) ||
        (is_begun && !Journal::is_of(journal, journal_title(plan, shard, keep_runs)))) {
      fail_in_file(
          is_done ? table : journal,
          "is of another sweep, or of this one under another program; allowed: a directory without it (--out)");
    }
    if (!is_done) missing.push_back(i);
  }
  return missing;
}

/// Runs one shard per task. It resumes, so that a task that was preempted, requeued or killed goes on where it was.
SlurmScript sweep_script(const SlurmOptions& options, const fs::path& directory, const std::vector<std::string>& sweep,
                         const std::vector<std::size_t>& shards) {
  return slurm_script(
      options, directory, "sweep", "slurm_shard_%a.log",
      {"array=" + array_text(shards), fmt::format("cpus-per-task={}", options.cpus), "requeue"},
      fmt::format("shard=$SLURM_ARRAY_TASK_ID\n"
                  "{0} --out {1} --quiet --resume --jobs {2} --shard \"$shard/{3}\"\n"
                  "status=$?\n"
                  "# The table notes runs that ended otherwise than expected (3) or could not be computed (1).\n"
                  "case $status in\n"
                  "  1 | 3) [ -e {1}/sweep_shard_\"$shard\"_of_{3}.csv ] || exit $status ;;\n"
                  "  *) exit $status ;;\n"
                  "esac\n",
                  shell_line(sweep), shell_line({directory.string()}), options.cpus, options.shards));
}

SlurmScript merge_script(const SlurmOptions& options, const fs::path& directory) {
  // Slurm removes this job when a shard fails for good; without the field it would wait for ever.
  return slurm_script(
      options, directory, "merge", "slurm_merge.log", {"kill-on-invalid-dep=yes"},
      fmt::format("exec {0} merge {1}/sweep_shard_*_of_{2}.csv --out {1}/sweep.csv\n",
                  shell_line({this_program().string()}), shell_line({directory.string()}), options.shards));
}

}  // namespace

SlurmJobs submit_to_slurm(const SweepPlan& plan, const SlurmOptions& options, const SweepOptions& sweep,
                          const std::vector<std::string>& command) {
  const fs::path directory = fs::absolute(sweep.directory).lexically_normal();
  const std::vector<std::size_t> shards = missing_shards(plan, options, sweep.keep_runs, directory);
  const auto earlier = options.dry_run ? std::nullopt : read_jobs(directory);
  if (earlier && !queued_tasks(earlier->array).empty()) {
    throw InputError(
        fmt::format("--slurm: job {} of {} is still in the queue; allowed: when it has ended (\"scancel {}\")",
                    earlier->array, directory.string(), earlier->array));
  }
  std::vector<SlurmScript> scripts = {merge_script(options, directory)};
  if (!shards.empty()) scripts.insert(scripts.begin(), sweep_script(options, directory, command, shards));
  for (const SlurmScript& script : scripts) write_file_atomically(script.file, script.text);
  SlurmJobs jobs;
  jobs.definition = plan.definition;
  jobs.runs = plan.points.size();
  jobs.shards = options.shards;
  if (options.dry_run) {
    jobs.text = dry_run_text(scripts);
    return jobs;
  }
  if (!shards.empty()) jobs.array = submit_script(scripts.front());
  write_jobs(directory, jobs);  // keeps the array's number in case the merge is refused
  jobs.merge = submit_script(scripts.back(), jobs.array);
  write_jobs(directory, jobs);
  jobs.text = fmt::format(
      "{} of {} shards submitted{}, the merge as job {}\n\"hapbench sweep --status {}\" shows their progress\n",
      shards.size(), options.shards, jobs.array.empty() ? "" : " as job " + jobs.array, jobs.merge, directory.string());
  return jobs;
}

namespace {

enum class ShardState {
  done,     ///< its table is there
  running,  ///< a process writes its journal, or Slurm runs it
  waiting,  ///< in Slurm's queue, perhaps again
  failed,   ///< begun, not done and not being worked on: killed, preempted, out of time, or a wrong command
  missing   ///< never begun
};

/// In the order of the enumeration.
constexpr std::array<const char*, 5> kStateNames = {"done", "running", "waiting", "failed", "missing"};

struct ShardStatus {
  Shard shard;
  ShardState state = ShardState::missing;
  std::size_t done = 0;  ///< runs on disk
};

/// The number of shards of the sweep in a directory; 0 when it is not divided.
std::size_t shards_in(const fs::path& directory) {
  static const std::regex kFile(R"(sweep(?:_shard_\d+_of_(\d+))?\.(?:csv|journal))");
  std::set<std::size_t> counts;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (std::smatch parts; std::regex_match(name, parts, kFile))
      counts.insert(whole_number(parts.str(1)).value_or(0));  // without shards the number is missing
  }
  if (error) fail_in_file(directory, fmt::format("cannot be read: {}", error.message()));
  if (counts.empty()) fail_in_file(directory, "holds no sweep; allowed: the directory that --out named");
  if (counts.size() > 1) counts.erase(0);  // sweep.csv, the merged table
  if (counts.size() > 1) {
    fail_in_file(directory, fmt::format("holds shards of several sweeps (of {} and of {}); allowed: one",
                                        *counts.begin(), *counts.rbegin()));
  }
  return *counts.begin();
}

/// Reads the files of one shard. Sets `runs` to the number of the whole sweep's when a table tells it.
ShardStatus status_by_files(const fs::path& directory, const std::optional<Shard>& shard,
                            std::optional<std::size_t>& runs) {
  ShardStatus status{shard.value_or(Shard{}), ShardState::missing, 0};
  const fs::path journal = journal_of(directory, shard), table = table_of(directory, shard);
  std::error_code ignored;
  if (fs::exists(journal, ignored)) {
    // A table beside a journal is an older one: writing the table removes the journal.
    status.state = Journal::is_being_written(journal) ? ShardState::running : ShardState::failed;
    status.done = Journal::count_rows(journal);
  } else if (fs::exists(table, ignored)) {
    status.state = ShardState::done;
    runs = shard ? ShardRows(table).title().runs : Journal::count_rows(table);  // lines behind the first, here too
  } else if (shard && fs::exists(directory / fmt::format("slurm_shard_{}.log", shard->index), ignored)) {
    status.state = ShardState::failed;
  }
  return status;
}

/// Corrects the states by Slurm's queue: a queued shard is neither failed nor missing.
void add_queue(const std::string& array, std::vector<ShardStatus>& shards) {
  for (const auto& [number, is_running] : queued_tasks(array)) {
    if (number >= shards.size() || shards[number].state == ShardState::done) continue;
    if (is_running) {
      shards[number].state = ShardState::running;
    } else if (shards[number].state != ShardState::running) {
      shards[number].state = ShardState::waiting;
    }
  }
}

std::string count_text(std::optional<std::size_t> count) {
  return count ? std::to_string(*count) : "?";
}

}  // namespace

std::vector<Table::Column> shard_headings() {
  return {{"shard", false, "i/n: the runs whose index leaves the remainder i on division by n"},
          {"state", false, "of a shard: done, running, waiting, failed or missing"},
          {"runs done", true, "runs of the shard with a row"},
          {"of", true, "of sweep --status: number of the shard's runs"}};
}

SweepStatus sweep_status(const fs::path& directory) {
  const SlurmJobs jobs = read_jobs(directory).value_or(SlurmJobs());
  const std::size_t count = jobs.shards > 0 ? jobs.shards : shards_in(directory);
  auto runs = jobs.shards > 0 ? std::optional(jobs.runs) : std::nullopt;
  std::vector<ShardStatus> shards;
  for (std::size_t i = 0; i < std::max<std::size_t>(count, 1); ++i) {
    shards.push_back(status_by_files(directory, count > 0 ? std::optional(Shard{i, count}) : std::nullopt, runs));
  }
  add_queue(jobs.array, shards);

  std::error_code ignored;
  const bool merged = fs::exists(directory / "sweep.csv", ignored);
  std::array<std::size_t, kStateNames.size()> counts{};
  std::size_t done = 0;
  Table table(shard_headings());
  Json list = Json::array();
  for (ShardStatus& shard : shards) {
    const auto size = runs ? std::optional(shard.shard.size(*runs)) : std::nullopt;
    if (shard.state == ShardState::done && size) shard.done = *size;
    ++counts[static_cast<std::size_t>(shard.state)];
    done += shard.done;
    const std::string name = shard_text(shard.shard), state = kStateNames[static_cast<std::size_t>(shard.state)];
    table.add({name, state, std::to_string(shard.done), count_text(size)});
    list.push_back({{"shard", name}, {"state", state}, {"runs_done", shard.done}});
  }
  SweepStatus status{table.text() + fmt::format("\n{} shards:", shards.size()),
                     {{"runs", runs ? Json(*runs) : Json(nullptr)}, {"runs_done", done}, {"merged", merged}}};
  for (std::size_t state = 0; state < counts.size(); ++state) {
    status.text += fmt::format(" {} {}{}", counts[state], kStateNames[state], state + 1 < counts.size() ? "," : ";");
    status.json[kStateNames[state]] = counts[state];
  }
  status.json["shards"] = std::move(list);
  status.text += fmt::format(" {} of {} runs; {}merged\n", done, count_text(runs), merged ? "" : "not ");
  if (!jobs.array.empty()) status.text += fmt::format("Slurm's jobs: array {}, merge {}\n", jobs.array, jobs.merge);
  const auto in_state = [&counts](ShardState state) { return counts[static_cast<std::size_t>(state)]; };
  const bool is_idle = in_state(ShardState::running) + in_state(ShardState::waiting) == 0;
  if (is_idle && in_state(ShardState::done) < shards.size())
    status.text += "to run what failed or is missing, give the same command again, with --slurm or with --resume\n";
  return status;
}

}  // namespace hapbench
