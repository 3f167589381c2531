#include "scenarios/program/sweep_slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/shell_words.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

fs::path jobs_file(const fs::path& directory) {
  return directory / "sweep_slurm.json";
}

fs::path table_of(const fs::path& directory, const Shard& shard) {
  return directory / (stem_of(shard) + ".csv");
}

/// The shards without a table. Refuses what is of another sweep: a merge would.
std::vector<std::size_t> missing_shards(const SweepPlan& plan, const SlurmOptions& options, const fs::path& directory) {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < options.shards; ++i) {
    const Shard shard{i, options.shards};
    const fs::path table = table_of(directory, shard), journal = directory / (stem_of(shard) + ".journal");
    const bool is_done = fs::exists(table), is_begun = fs::exists(journal);
    const bool is_other = (is_done && ShardRows(table).title().definition != plan.definition) ||
                          (is_begun && !Journal::is_of(journal, journal_title(plan, shard, options.keep_runs)));
    if (is_other) {
      fail_in_file(
          is_done ? table : journal,
          "is of another sweep, or of this one under another program; allowed: a directory without it (--out)");
    }
    if (!is_done) missing.push_back(i);
  }
  return missing;
}

/// Numbers in order as Slurm takes them: "0-3,7".
std::string array_text(const std::vector<std::size_t>& numbers) {
  std::vector<std::string> ranges;
  for (std::size_t i = 0, last = 0; i < numbers.size(); i = last + 1) {
    last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    ranges.push_back(last == i ? std::to_string(numbers[i]) : fmt::format("{}-{}", numbers[i], numbers[last]));
  }
  return fmt::format("{}", fmt::join(ranges, ","));
}

/// The lines that both scripts begin with.
std::string script_head(const SlurmOptions& options, const char* name, const fs::path& log) {
  std::string head = fmt::format(
      "#!/bin/bash\n"
      "# Written by \"hapbench sweep --slurm\".\n"
      "#SBATCH --job-name={}\n"
      "#SBATCH --output=\"{}\"\n"
      "#SBATCH --open-mode=append\n",
      name, log.string());
  if (!options.partition.empty()) head += fmt::format("#SBATCH --partition={}\n", options.partition);
  if (!options.time.empty()) head += fmt::format("#SBATCH --time={}\n", options.time);
  return head;
}

/// What is left of a shard, so that a task that was preempted, requeued or killed goes on where it was.
std::string sweep_script(const SlurmOptions& options, const fs::path& directory, const std::vector<std::string>& sweep,
                         const std::vector<std::size_t>& shards) {
  return script_head(options, "hapbench-sweep", directory / "slurm_shard_%a.log") +
         fmt::format(
             "#SBATCH --array={0}\n"
             "#SBATCH --cpus-per-task={1}\n"
             "#SBATCH --requeue\n"
             "shard=$SLURM_ARRAY_TASK_ID\n"
             "{2} --out {3} --quiet --resume --jobs {1} --shard \"$shard/{4}\"\n"
             "status=$?\n"
             "# Runs that ended otherwise than expected (3) or could not be computed (1) are in the table as such.\n"
             "case $status in\n"
             "  1 | 3) [ -e {3}/sweep_shard_\"$shard\"_of_{4}.csv ] || exit $status ;;\n"
             "  *) exit $status ;;\n"
             "esac\n",
             array_text(shards), options.cpus, shell_line(sweep), shell_line({directory.string()}), options.shards);
}

std::string merge_script(const SlurmOptions& options, const fs::path& directory) {
  return script_head(options, "hapbench-merge", directory / "slurm_merge.log") +
         fmt::format(
             "# When a shard fails for good, it goes, rather than wait for ever.\n"
             "#SBATCH --kill-on-invalid-dep=yes\n"
             "exec {0} merge {1}/sweep_shard_*_of_{2}.csv --out {1}/sweep.csv\n",
             shell_line({this_program().string()}), shell_line({directory.string()}), options.shards);
}

/// The number of the new job.
std::string submitted(const std::vector<std::string>& words) {
  const ProgramOutput output = output_of(words);
  std::string_view last;  // warnings come before it
  std::string said;
  for (LineReader lines(output.text); const auto line = lines.next();) {
    last = *line;
    said += fmt::format("{}{}", said.empty() ? "" : "; ", last);
  }
  const std::string_view number = last.substr(0, last.find(';'));  // the cluster may follow
  if (output.status == 0 && whole_number(number)) return std::string(number);
  if (output.status == 127) throw InputError("--slurm: got no sbatch here; allowed: where Slurm is, or with --dry-run");
  throw InputError(
      fmt::format("--slurm: \"{}\" says: {}; allowed: what it accepts (of --slurm less than MaxArraySize in "
                  "\"scontrol show config\")",
                  shell_line(words), said));
}

/// The scripts, and how to submit them; without the array's file the merge alone.
std::string dry_run_text(const std::string& array_file, const std::string& array, const std::string& merge_file,
                         const std::string& merge) {
  std::string text = array_file.empty() ? "" : fmt::format("# {}\n{}\n", array_file, array);
  text += fmt::format("# {}\n{}\n# nothing is submitted (--dry-run); to do so:\n", merge_file, merge);
  if (array_file.empty()) return text + "sbatch " + shell_line({merge_file}) + "\n";
  return text + fmt::format("id=$(sbatch --parsable {})\nsbatch --dependency=afterok:$id {}\n",
                            shell_line({array_file}), shell_line({merge_file}));
}

void refuse_while_queued(const fs::path& directory) {
  const auto jobs = jobs_of(directory);
  if (!jobs || queued_tasks(jobs->array).empty()) return;
  throw InputError(
      fmt::format("--slurm: job {} of {} is still in the queue; allowed: when it has ended (\"scancel {}\")",
                  jobs->array, directory.string(), jobs->array));
}

}  // namespace

fs::path log_of(const fs::path& directory, std::size_t shard) {
  return directory / fmt::format("slurm_shard_{}.log", shard);
}

std::optional<SlurmJobs> jobs_of(const fs::path& directory) {
  const fs::path file = jobs_file(directory);
  if (std::error_code ignored; !fs::exists(file, ignored)) return std::nullopt;
  try {
    const Json json = parse_json(read_text_file(file, kLargestJsonFile));
    return SlurmJobs{json.at("definition"), json.at("runs"), json.at("shards"), json.at("array"), json.at("merge")};
  } catch (const Json::exception&) {
    fail_in_file(file, "is not what \"hapbench sweep --slurm\" writes");
  } catch (const InputError& error) {
    fail_in_file(file, error.what());
  }
}

std::vector<std::pair<std::size_t, std::string>> queued_tasks(const std::string& array) {
  std::vector<std::pair<std::size_t, std::string>> tasks;
  if (array.empty()) return tasks;
  const ProgramOutput output = output_of({"squeue", "--noheader", "--array", "--jobs=" + array, "--format=%K %T"});
  LineReader lines(output.text);
  while (const auto line = lines.next()) {
    const Words words = words_of(*line);
    const auto shard = words.size() == 2 ? whole_number(words[0]) : std::nullopt;
    if (output.status == 0 && shard) tasks.emplace_back(*shard, words[1] == "PENDING" ? "PENDING" : "RUNNING");
  }
  return tasks;
}

std::string submit_to_slurm(const SweepPlan& plan, const SlurmOptions& options, const fs::path& given,
                            const std::vector<std::string>& sweep) {
  const fs::path directory = fs::absolute(given).lexically_normal();
  const std::vector<std::size_t> shards = missing_shards(plan, options, directory);
  if (!options.dry_run) refuse_while_queued(directory);
  const fs::path array_file = directory / "sweep.sbatch", merge_file = directory / "merge.sbatch";
  const std::string array = sweep_script(options, directory, sweep, shards), merge = merge_script(options, directory);
  if (!shards.empty()) write_file_atomically(array_file, array);
  write_file_atomically(merge_file, merge);
  if (options.dry_run)
    return dry_run_text(shards.empty() ? "" : array_file.string(), array, merge_file.string(), merge);
  SlurmJobs jobs{plan.definition, plan.points.size(), options.shards, "", ""};
  std::vector<std::string> merge_words = {"sbatch", "--parsable"};
  if (!shards.empty()) {
    jobs.array = submitted({"sbatch", "--parsable", array_file.string()});
    merge_words.push_back("--dependency=afterok:" + jobs.array);
  }
  merge_words.push_back(merge_file.string());
  const auto note = [&] {
    write_file_atomically(jobs_file(directory), json_text({{"definition", jobs.definition},
                                                           {"runs", jobs.runs},
                                                           {"shards", jobs.shards},
                                                           {"array", jobs.array},
                                                           {"merge", jobs.merge}}));
  };
  note();  // should the merge be refused, the array is known all the same
  jobs.merge = submitted(merge_words);
  note();
  return fmt::format(
      "{} of {} shards submitted{}, the merge as job {}\n\"hapbench sweep --status {}\" says how far they are\n",
      shards.size(), options.shards, jobs.array.empty() ? "" : " as job " + jobs.array, jobs.merge, directory.string());
}

}  // namespace hapbench
