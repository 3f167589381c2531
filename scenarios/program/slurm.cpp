#include "scenarios/program/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

void add_slurm_options(Command& command, SlurmOptions& options, CommandOption& shard, const std::string& help) {
  CommandOption slurm = command.add("--slurm", options.shards, help);
  slurm.range(1, kMostRuns).excludes(shard);
  command.add("--time", options.time, "time limit of a task, as sbatch takes it: 30, 2:00:00, 1-0").needs(slurm);
  command.add("--cpus", options.cpus, "processors of a task, which does as many runs at once (default: 1)")
      .range(1, 1024)
      .needs(slurm);
  command.add("--partition", options.partition, "partition of the cluster (default: the cluster's own default)")
      .needs(slurm);
  command.flag("--dry-run", options.dry_run, "write and print the scripts, submit nothing").needs(slurm);
}

SlurmScript slurm_script(const SlurmOptions& options, const std::filesystem::path& directory, const std::string& name,
                         const std::string& log, const std::vector<std::string>& fields, const std::string& lines) {
  for (const std::string& value : {options.time, options.partition}) {
    constexpr const char* kUsual = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-:.,";
    if (value.find_first_not_of(kUsual) == std::string::npos) continue;
    throw InputError(fmt::format("--time, --partition: got \"{}\"; allowed: letters, digits and _-:.,", value));
  }
  // A line of a script ends with it, whatever quotes are around.
  const std::string& text = directory.native();
  if (std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7f; }))
    throw InputError("--out: got a path with a control character; allowed with --slurm: paths without");
  std::vector<std::string> all = {"job-name=hapbench-" + name, fmt::format("output=\"{}\"", (directory / log).string()),
                                  "open-mode=append"};
  if (!options.partition.empty()) all.push_back("partition=" + options.partition);
  if (!options.time.empty()) all.push_back("time=" + options.time);
  all.insert(all.end(), fields.begin(), fields.end());
  return {directory / (name + ".sbatch"),
          fmt::format("#!/bin/bash\n# Written by \"hapbench --slurm\".\n#SBATCH --{}\n{}",
                      fmt::join(all, "\n#SBATCH --"), lines)};
}

std::string array_text(const std::vector<std::size_t>& numbers) {
  std::vector<std::string> ranges;
  for (std::size_t i = 0, last = 0; i < numbers.size(); i = last + 1) {
    last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    ranges.push_back(last == i ? std::to_string(numbers[i]) : fmt::format("{}-{}", numbers[i], numbers[last]));
  }
  return fmt::format("{}", fmt::join(ranges, ","));
}

std::string submit_script(const SlurmScript& script, const std::string& after) {
  std::vector<std::string> words = {"sbatch", "--parsable", script.file.string()};
  if (!after.empty()) words.insert(words.begin() + 2, "--dependency=afterok:" + after);
  const ProgramOutput output = output_of(words);
  std::vector<std::string_view> lines;
  for (LineReader reader(output.text); const auto line = reader.next();) lines.push_back(*line);
  // Warnings stand before the number; the cluster's name may follow it.
  const std::string_view last = lines.empty() ? "" : lines.back(), number = last.substr(0, last.find(';'));
  if (output.status == 0 && whole_number(number)) return std::string(number);
  if (output.status == 127) throw InputError("--slurm: got no sbatch here; allowed: where Slurm is, or with --dry-run");
  throw InputError(
      fmt::format("--slurm: \"{}\" says: {}; allowed: what it accepts (of --slurm less than MaxArraySize in "
                  "\"scontrol show config\")",
                  shell_line(words), fmt::join(lines, "; ")));
}

std::string dry_run_text(const std::vector<SlurmScript>& scripts) {
  std::string texts, commands;
  for (std::size_t i = 0; i < scripts.size(); ++i) {
    texts += fmt::format("# {}\n{}\n", scripts[i].file.string(), scripts[i].text);
    const std::string words =
        fmt::format("sbatch {}{}", i > 0 ? "--dependency=afterok:$id " : "",
                    (i + 1 < scripts.size() ? "--parsable " : "") + shell_line({scripts[i].file.string()}));
    commands += i + 1 < scripts.size() ? fmt::format("id=$({})\n", words) : words + "\n";
  }
  return texts + "# nothing is submitted (--dry-run); to do so:\n" + commands;
}

}  // namespace hapbench
