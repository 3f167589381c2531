#include "scenarios/program/sweep_status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/sweep_slurm.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr ShardState kStates[] = {ShardState::done, ShardState::running, ShardState::waiting, ShardState::failed,
                                  ShardState::missing};

const char* name_of(ShardState state) {
  constexpr const char* kNames[] = {"done", "running", "waiting", "failed", "missing"};
  return kNames[static_cast<std::size_t>(state)];
}

/// The number of shards that a file of a sweep tells of: 0 for one without shards, none for other files.
std::optional<std::size_t> shards_named_by(const fs::path& file) {
  const std::string stem = file.stem().string(), kind = file.extension().string();
  if (kind != ".csv" && kind != ".journal") return std::nullopt;
  if (stem == "sweep") return 0;
  const Words words = parts_of(stem, '_');  // sweep_shard_I_of_N
  const bool is_shard = words.size() == 5 && words[0] == "sweep" && words[1] == "shard" && words[3] == "of";
  return is_shard ? whole_number(words[4]) : std::nullopt;
}

/// Into how many shards the sweep is divided; 0: it is not.
std::size_t shards_in(const fs::path& directory) {
  std::set<std::size_t> counts;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
    if (const auto count = shards_named_by(entry->path())) counts.insert(*count);
  }
  if (error) fail_in_file(directory, fmt::format("cannot be read: {}", error.message()));
  if (counts.empty()) fail_in_file(directory, "holds no sweep; allowed: the directory that --out named");
  if (counts.size() > 1) counts.erase(0);  // which the others were merged into
  if (counts.size() > 1) {
    fail_in_file(directory, fmt::format("holds shards of several sweeps (of {} and of {}); allowed: one",
                                        *counts.begin(), *counts.rbegin()));
  }
  return *counts.begin();
}

/// What the files of one shard say; `runs` learns how many the sweep has.
ShardStatus status_by_files(const fs::path& directory, const std::optional<Shard>& shard,
                            std::optional<std::size_t>& runs) {
  ShardStatus status{shard.value_or(Shard{}), ShardState::missing, 0};
  const fs::path journal = directory / (stem_of(shard) + ".journal"), table = directory / (stem_of(shard) + ".csv");
  std::error_code ignored;
  if (fs::exists(journal, ignored)) {
    // Runs again when there is a table, too: the journal goes when the table is written.
    status.state = Journal::is_being_written(journal) ? ShardState::running : ShardState::failed;
    status.done = Journal::count_rows(journal);
  } else if (fs::exists(table, ignored)) {
    status.state = ShardState::done;
    runs = shard ? ShardRows(table).title().runs : Journal::count_rows(table);  // lines behind the first, here too
  } else if (shard && fs::exists(log_of(directory, shard->index), ignored)) {
    status.state = ShardState::failed;
  }
  return status;
}

/// What is queued is not failed, nor missing.
void add_queue(const std::string& array, std::vector<ShardStatus>& shards) {
  for (const auto& [number, state] : queued_tasks(array)) {
    if (number >= shards.size() || shards[number].state == ShardState::done) continue;
    if (state != "PENDING") {
      shards[number].state = ShardState::running;
    } else if (shards[number].state != ShardState::running) {
      shards[number].state = ShardState::waiting;
    }
  }
}

std::map<ShardState, std::size_t> counts_of(const SweepStatus& status) {
  std::map<ShardState, std::size_t> counts;
  for (const ShardStatus& shard : status.shards) ++counts[shard.state];
  return counts;
}

std::size_t runs_done(const SweepStatus& status) {
  std::size_t done = 0;
  for (const ShardStatus& shard : status.shards) done += shard.done;
  return done;
}

std::string count_text(std::optional<std::size_t> count) {
  return count ? std::to_string(*count) : "?";
}

}  // namespace

SweepStatus sweep_status(const fs::path& directory) {
  SweepStatus status;
  const auto jobs = jobs_of(directory);
  const std::size_t count = jobs ? jobs->shards : shards_in(directory);
  if (jobs) {
    status.runs = jobs->runs;
    status.array = jobs->array;
    status.merge = jobs->merge;
  }
  for (std::size_t i = 0; i < std::max<std::size_t>(count, 1); ++i) {
    const auto shard = count > 0 ? std::optional(Shard{i, count}) : std::nullopt;
    status.shards.push_back(status_by_files(directory, shard, status.runs));
  }
  add_queue(status.array, status.shards);
  for (ShardStatus& shard : status.shards) {
    if (shard.state == ShardState::done && status.runs) shard.done = shard.shard.size(*status.runs);
  }
  std::error_code ignored;
  status.merged = fs::exists(directory / "sweep.csv", ignored);
  return status;
}

std::string status_text(const SweepStatus& status) {
  Table table({{"shard", false}, {"state", false}, {"runs done"}, {"of"}});
  for (const ShardStatus& shard : status.shards) {
    const auto size = status.runs ? std::optional(shard.shard.size(*status.runs)) : std::nullopt;
    table.add({shard_text(shard.shard), name_of(shard.state), std::to_string(shard.done), count_text(size)});
  }
  std::string text = table.text() + fmt::format("\n{} shards:", status.shards.size());
  auto counts = counts_of(status);
  for (const ShardState state : kStates) text += fmt::format(" {} {},", counts[state], name_of(state));
  text.back() = ';';
  text += fmt::format(" {} of {} runs; {}merged\n", runs_done(status), count_text(status.runs),
                      status.merged ? "" : "not ");
  if (!status.array.empty()) text += fmt::format("Slurm's jobs: array {}, merge {}\n", status.array, status.merge);
  const bool is_idle = counts[ShardState::running] + counts[ShardState::waiting] == 0;
  if (is_idle && counts[ShardState::done] < status.shards.size()) {
    text += "what failed or is missing: the same command again, with --slurm or with --resume\n";
  }
  return text;
}

Json status_json(const SweepStatus& status) {
  Json shards = Json::array();
  for (const ShardStatus& shard : status.shards) {
    shards.push_back({{"shard", shard_text(shard.shard)}, {"state", name_of(shard.state)}, {"runs_done", shard.done}});
  }
  Json json = {{"runs", nullptr}, {"runs_done", runs_done(status)}, {"merged", status.merged}};
  if (status.runs) json["runs"] = *status.runs;
  auto counts = counts_of(status);
  for (const ShardState state : kStates) json[name_of(state)] = counts[state];
  json["shards"] = std::move(shards);
  return json;
}

}  // namespace hapbench
