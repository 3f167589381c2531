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
  const fs::path file = options.out;
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw InputError(fmt::format("--out {}: is a directory", file.string()));
  require_writable_directory(file.has_parent_path() ? file.parent_path() : ".");
  const std::size_t shards = options.files.size();
  const std::size_t runs = merge_shard_tables(file, std::vector<fs::path>(options.files.begin(), options.files.end()));
  print(options.output, fmt::format("{} runs of {} shards in {}\n", runs, shards, file.string()),
        {{"runs", runs}, {"shards", shards}, {"file", file.string()}});
  return kSuccess;
}

}  // namespace

void add_merge(CommandLine& line) {
  auto options = std::make_shared<MergeOptions>();
  Command command = line.command("merge", "Put the tables of all shards of a sweep together");
  command.add("files", options->files, "sweep_shard_I_of_N.csv of every I, in any order").required();
  command
      .add("--out", options->out,
           "file of the table: the same bytes as sweep.csv of the sweep without shards; what it is a function of goes "
           "beside it, as sweep.json does")
      .required();
  add_output_options(command, options->output);
  command.runs([options] { return merge(*options); });
}

}  // namespace hapbench
