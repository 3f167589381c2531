#include <fmt/format.h>

#include <memory>

#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/program/command.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct MergeOptions {
  std::vector<std::string> files;
  std::string out;
  OutputOptions output;
};

int merge(const MergeOptions& options) {
  std::vector<ShardTable> shards;
  for (const std::string& file : options.files) shards.push_back(read_shard_table(file));
  check_complete(shards);
  const fs::path file = options.out;
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw InputError(fmt::format("--out {}: is a directory", file.string()));
  require_writable_directory(file.has_parent_path() ? file.parent_path() : ".");
  merge_shard_tables(file, shards);
  print(options.output, fmt::format("{} runs of {} shards in {}\n", shards[0].runs, shards.size(), file.string()),
        {{"runs", shards[0].runs}, {"shards", shards.size()}, {"file", file.string()}});
  return kSuccess;
}

}  // namespace

void add_merge(CommandLine& line) {
  auto options = std::make_shared<MergeOptions>();
  Command command = line.command("merge", "Put the tables of all shards of a sweep together");
  command.add("files", options->files, "sweep_shard_I_of_N.csv of every I, in any order").required();
  command.add("--out", options->out, "file of the table: the same bytes as sweep.csv of the sweep without shards")
      .required();
  add_output_options(command, options->output);
  command.runs([options] { return merge(*options); });
}

}  // namespace hapbench
