#include "scenarios/batch/join_shards.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/shard.hpp"
#include "scenarios/batch/table_description.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/batch/table_lines.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/folder_lock.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Returns the number n of shards in a folder's tables ("sweep.I_of_n.csv"); 0 if there are no such tables. Throws
/// InputError if tables have different n.
std::size_t shards_in(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    std::size_t index = 0, of = 0;
    if (std::sscanf(entry.path().filename().c_str(), "sweep.%zu_of_%zu.csv", &index, &of) != 2) continue;
    if (entry.path().filename() != table_name(Shard{index, of}) || of > kMaxRuns) continue;
    if (count != 0 && of != count) {
      fail_in_file(
          entry.path(),
          fmt::format(
              "belongs to a sweep of {} shards, another file to a sweep of {} shards; allowed: shards of one sweep", of,
              count));
    }
    count = of;
  }
  return count;
}

}  // namespace

bool join_shards(const fs::path& folder) {
  constexpr std::size_t kMaxShown = 10;
  const std::size_t count = shards_in(folder);
  const fs::path whole = folder / table_name(std::nullopt);
  std::error_code ignored;
  // Find the tables of all shards.
  std::vector<fs::path> shards;
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < count; ++i) {
    shards.push_back(folder / table_name(Shard{i, count}));
    if (!fs::exists(shards.back(), ignored)) missing.push_back(shard_text({i, count}));
  }
  if (count == 0 || (!missing.empty() && fs::exists(whole, ignored))) return false;
  if (const std::size_t missing_count = missing.size(); missing_count > 0) {
    missing.resize(std::min(missing_count, kMaxShown));
    throw InputError(fmt::format("{}: {} of {} shards missing: {}{}", folder.string(), missing_count, count,
                                 fmt::join(missing, ", "), missing_count > kMaxShown ? ", ..." : ""));
  }
  // Check that all shards belong to the same sweep.
  TableTitle title{whole, "", read_json(description_file(shards[0]))};
  const std::string definition = title.about.value("definition", "");
  for (const fs::path& shard : shards) {
    if (const std::string other = definition_in(description_file(shard)); other != definition) {
      fail_in_file(shard,
                   fmt::format("is of another sweep than {}: definition {}, there {}; allowed: shards of one sweep",
                               shards[0].string(), other, definition));
    }
  }
  // Join the rows, sorted by case.
  title.cases = std::min(title.about.value("runs", std::size_t{0}), kMaxRuns);
  title.about["shard"] = shard_text({});
  TableLines first(shards[0], 0);
  first.next();
  title.header = first.line();
  NewDirectories no_directories;
  const FolderLock lock(no_directories, folder, whole.filename().string(), "sweep");
  if (const std::size_t found = write_sorted_table(title, shards, title.cases); found != title.cases) {
    throw InputError(fmt::format("{}: the shards have {} of {} rows; allowed: complete tables", folder.string(), found,
                                 title.cases));
  }
  return true;
}

}  // namespace hapbench
