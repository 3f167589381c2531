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

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The number of shards that the tables of a folder are of; 0 without any. Throws InputError when they are not of one.
std::size_t shards_in(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    std::size_t index = 0, of = 0;
    if (std::sscanf(entry.path().filename().c_str(), "sweep.%zu_of_%zu.csv", &index, &of) != 2) continue;
    if (entry.path().filename() != table_name(Shard{index, of}) || of > kMostRuns) continue;
    if (count != 0 && of != count) {
      fail_in_file(entry.path(),
                   fmt::format("is one of {} shards, another one of {}; allowed: shards of one division", of, count));
    }
    count = of;
  }
  return count;
}

}  // namespace

bool join_shards(const fs::path& folder) {
  constexpr std::size_t kMostShown = 10;
  const std::size_t count = shards_in(folder);
  const fs::path whole = folder / table_name(std::nullopt);
  std::error_code ignored;
  std::vector<fs::path> shards;
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < count; ++i) {
    shards.push_back(folder / table_name(Shard{i, count}));
    if (!fs::exists(shards.back(), ignored)) missing.push_back(shard_text({i, count}));
  }
  if (count == 0 || (!missing.empty() && fs::exists(whole, ignored))) return false;
  if (const std::size_t lack = missing.size(); lack > 0) {
    missing.resize(std::min(lack, kMostShown));
    throw InputError(fmt::format("{}: {} of {} shards missing: {}{}", folder.string(), lack, count,
                                 fmt::join(missing, ", "), lack > kMostShown ? ", ..." : ""));
  }
  TableTitle title{whole, "", read_json(beside(shards[0]))};
  const std::string definition = title.about.value("definition", "");
  for (const fs::path& shard : shards) {
    if (const std::string other = definition_in(beside(shard)); other != definition) {
      fail_in_file(shard,
                   fmt::format("is of another sweep than {}: definition {}, there {}; allowed: shards of one sweep",
                               shards[0].string(), other, definition));
    }
  }
  title.cases = std::min(title.about.value("runs", std::size_t{0}), kMostRuns);
  title.about["shard"] = shard_text({});
  TableLines first(shards[0], 0);
  first.next();
  title.header = first.line();
  if (const std::size_t found = put_in_order(title, shards, title.cases); found != title.cases) {
    throw InputError(fmt::format("{}: the shards have {} of {} rows; allowed: complete tables", folder.string(), found,
                                 title.cases));
  }
  return true;
}

}  // namespace hapbench
