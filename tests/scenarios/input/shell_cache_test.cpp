#include "scenarios/input/shell_cache.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cstring>
#include <limits>

#include "sim/core/hash.hpp"
#include "sim/core/random.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/environment_variable.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using test::read_file;
using test::write_plainly;

const std::string kDefinition = "a block with a hole";

/// Points, each in a cell.
ShellPoints random_points(std::size_t count, std::uint64_t seed = 1) {
  Random random(seed);
  ShellPoints shell;
  for (std::size_t i = 0; i < count; ++i) {
    shell.points.push_back({random.direction() * 0.01, random.direction()});
    shell.cells.push_back(static_cast<std::uint32_t>(i / 4));
  }
  return shell;
}

bool same_bits(const ShellPoints& a, const ShellPoints& b) {
  return a.points.size() == b.points.size() && a.cells == b.cells &&
         std::memcmp(static_cast<const void*>(a.points.data()), b.points.data(),
                     a.points.size() * sizeof(SurfacePoint)) == 0;
}

std::string file_name(const std::string& definition) {
  return hash_text(hash_of(definition)) + ".shell";
}

class ShellCacheFile : public testing::Test {
 protected:
  /// Replaces the file by a new one: see write_anew in fuzz_test.cpp.
  void put(const std::string& bytes) const {
    fs::remove(file_);
    write_plainly(file_, bytes);
  }
  /// The contents are not taken for points, and keeping the points puts a good file in their place.
  void expect_rebuilt(const std::string& bytes, const std::string& what) {
    put(bytes);
    EXPECT_FALSE(cache_.find(kDefinition)) << what;
    cache_.keep(kDefinition, points_);
    ASSERT_TRUE(read_file(file_) == good_) << what;
  }

  test::TemporaryDirectory directory_;
  ShellCache cache_{directory_.path()};
  const ShellPoints points_ = random_points(2);  // few, so that every bit can have its turn
  const fs::path file_ = directory_ / file_name(kDefinition);
  const std::string good_ = [this] {
    cache_.keep(kDefinition, points_);
    return read_file(file_);
  }();
};

TEST_F(ShellCacheFile, GivesBackEveryBit) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), tiny = std::numeric_limits<double>::denorm_min();
  ShellPoints points = random_points(10'000);
  points.points.push_back({{-0.0, 0.0, tiny}, {nan, -nan, -std::numeric_limits<double>::infinity()}});
  points.cells.push_back(0xffffffff);
  cache_.keep("odd numbers", points);
  const auto found = cache_.find("odd numbers");
  ASSERT_TRUE(found);
  EXPECT_TRUE(same_bits(*found, points));
}

TEST_F(ShellCacheFile, MayHoldPointsWithoutCells) {
  const ShellPoints points{random_points(100).points, {}};
  cache_.keep("no cells", points);
  const auto found = cache_.find("no cells");
  ASSERT_TRUE(found);
  EXPECT_TRUE(same_bits(*found, points));
}

TEST_F(ShellCacheFile, MayHoldNoPoints) {
  cache_.keep("nothing", {});
  ASSERT_TRUE(cache_.find("nothing"));
  EXPECT_TRUE(cache_.find("nothing")->points.empty());
}

TEST_F(ShellCacheFile, IsNotFoundUnderAnotherDefinition) {
  EXPECT_TRUE(cache_.find(kDefinition));
  EXPECT_FALSE(cache_.find(kDefinition + " "));
  EXPECT_FALSE(cache_.find(""));
}

TEST_F(ShellCacheFile, WithAnyBitFlippedIsRebuilt) {
  for (std::size_t bit = 0; bit < 8 * good_.size(); ++bit) {
    std::string bytes = good_;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
    expect_rebuilt(bytes, "bit " + std::to_string(bit));
  }
}

TEST_F(ShellCacheFile, CutAnywhereIsRebuilt) {
  for (std::size_t size = 0; size < good_.size(); ++size) {
    expect_rebuilt(good_.substr(0, size), std::to_string(size) + " bytes");
  }
}

TEST_F(ShellCacheFile, WithMoreBehindItsEndIsRebuilt) {
  expect_rebuilt(good_ + '\0', "one byte more");
  expect_rebuilt(good_ + good_, "twice");
}

TEST_F(ShellCacheFile, WithPartsSwappedOrZeroIsRebuilt) {
  const std::size_t half = sizeof(SurfacePoint), cells = good_.size() - 2 * sizeof(std::uint32_t);
  const std::size_t start = cells - 2 * half;
  expect_rebuilt(
      good_.substr(0, start) + good_.substr(start + half, half) + good_.substr(start, half) + good_.substr(cells),
      "points swapped");
  expect_rebuilt(good_.substr(0, start) + std::string(2 * half, '\0') + good_.substr(cells), "zero points");
  expect_rebuilt(std::string(good_.size(), '\0'), "zeros");
}

TEST_F(ShellCacheFile, OfAnotherDefinitionUnderTheSameNameIsRebuilt) {
  // As if two definitions had one hash: same length, same points, a checksum that is right.
  const std::string other = "A block with a hole";
  ASSERT_EQ(other.size(), kDefinition.size());
  cache_.keep(other, points_);
  expect_rebuilt(read_file(directory_ / file_name(other)), "other definition");
}

/// Byte offsets of the numbers in the header.
constexpr std::size_t kDefinitionSizeAt = 8, kPointsAt = 16, kCellsAt = 24;

TEST_F(ShellCacheFile, WithHugeCountsIsRebuiltWithoutAllocatingForThem) {
  for (const std::size_t at : {kDefinitionSizeAt, kPointsAt, kCellsAt}) {
    // Among them counts whose bytes overflow to the file's true size.
    for (const std::uint64_t count : {~std::uint64_t{0}, std::uint64_t{1} << 63, (std::uint64_t{1} << 60) + 2,
                                      std::uint64_t{1} << 32, std::uint64_t{20'000'000}}) {
      std::string bytes = good_;
      std::memcpy(bytes.data() + at, &count, sizeof count);
      expect_rebuilt(bytes, "count " + std::to_string(count));
    }
  }
}

TEST_F(ShellCacheFile, AsLargeAsItsHugeCountClaimsIsRebuilt) {
  std::string bytes = good_;
  const std::uint64_t count = std::uint64_t{1} << 40;
  std::memcpy(bytes.data() + kPointsAt, &count, sizeof count);
  put(bytes);
  // A file with a hole, without blocks on the disk. Not every file system has files so large.
  std::error_code error;
  fs::resize_file(file_, good_.size() + (count - points_.points.size()) * sizeof(SurfacePoint), error);
  EXPECT_FALSE(cache_.find(kDefinition));
  cache_.keep(kDefinition, points_);
  EXPECT_TRUE(read_file(file_) == good_);
}

TEST_F(ShellCacheFile, MayHaveAPipeInItsPlace) {
  fs::remove(file_);
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  EXPECT_FALSE(cache_.find(kDefinition));  // and does not wait for a writer
  cache_.keep(kDefinition, points_);
  EXPECT_TRUE(read_file(file_) == good_);
}

TEST_F(ShellCacheFile, MayHaveADirectoryInItsPlace) {
  fs::remove(file_);
  fs::create_directories(file_ / "with something in it");
  EXPECT_FALSE(cache_.find(kDefinition));
  cache_.keep(kDefinition, points_);
  EXPECT_FALSE(cache_.find(kDefinition));
  EXPECT_EQ(directory_.entries().size(), 1u);  // no temporary
}

TEST_F(ShellCacheFile, MayBeALinkToNowhere) {
  fs::remove(file_);
  fs::create_symlink("nowhere", file_);
  EXPECT_FALSE(cache_.find(kDefinition));
  cache_.keep(kDefinition, points_);
  EXPECT_TRUE(read_file(file_) == good_);
  EXPECT_FALSE(fs::is_symlink(file_));
}

TEST_F(ShellCacheFile, IsLeftOutWhenTheDiskIsFull) {
  const test::FileSizeLimit full(1000);
  cache_.keep("larger than the disk", random_points(1000));
  EXPECT_FALSE(cache_.find("larger than the disk"));
  EXPECT_EQ(directory_.entries().size(), 1u);
}

TEST(ShellCacheDirectory, IsMadeByTheFirstShell) {
  const test::TemporaryDirectory directory;
  const ShellCache cache(directory / "deep/er");
  EXPECT_FALSE(cache.find(kDefinition));
  EXPECT_FALSE(fs::exists(directory / "deep"));
  cache.keep(kDefinition, random_points(3));
  EXPECT_TRUE(cache.find(kDefinition));
}

TEST(ShellCacheDirectory, ThatCannotBeIsNoError) {
  const test::TemporaryDirectory directory;
  write_plainly(directory / "file", "");
  const ShellCache cache(directory / "file/below");
  cache.keep(kDefinition, random_points(3));
  EXPECT_FALSE(cache.find(kDefinition));
  EXPECT_EQ(cache.contents().shells, 0u);
}

TEST(ShellCacheDirectory, ThatIsEmptyMeansNoCaching) {
  const test::TemporaryDirectory directory;
  const fs::path before = fs::current_path();
  fs::current_path(directory.path());
  for (const ShellCache& off : {ShellCache(), ShellCache("")}) {
    EXPECT_FALSE(off.is_on());
    off.keep(kDefinition, random_points(3));
    EXPECT_FALSE(off.find(kDefinition));
  }
  fs::current_path(before);
  EXPECT_TRUE(directory.entries().empty());
}

TEST(ShellCacheDirectory, LosesTheLeavingsOfKilledWriters) {
  const test::TemporaryDirectory directory;
  write_plainly(directory / ".0123456789abcdef.shell.4000000.tmp", "half a shell");
  ShellCache(directory.path()).keep(kDefinition, random_points(3));
  EXPECT_EQ(directory.entries().size(), 1u);
}

/// A cache with room for three of these shells, and four kept, an hour after each other.
class FullShellCache : public testing::Test {
 protected:
  FullShellCache() {
    for (int i = 0; i < 3; ++i) {
      cache_.keep(name(i), points_);
      const auto hours_ago = std::chrono::hours(10 - i);
      fs::last_write_time(directory_ / file_name(name(i)), fs::file_time_type::clock::now() - hours_ago);
    }
  }
  static std::string name(int i) { return "shell " + std::to_string(i); }

  test::TemporaryDirectory directory_;
  const ShellPoints points_ = random_points(100);
  const std::uintmax_t one_ = 40 + name(0).size() + 100 * (sizeof(SurfacePoint) + sizeof(std::uint32_t));
  ShellCache cache_{directory_.path(), 3 * one_};
};

TEST_F(FullShellCache, LosesTheOldestShell) {
  EXPECT_EQ(cache_.contents().bytes, 3 * one_);
  cache_.keep(name(3), points_);
  EXPECT_EQ(cache_.contents().shells, 3u);
  EXPECT_FALSE(cache_.find(name(0)));
  for (int i = 1; i < 4; ++i) EXPECT_TRUE(cache_.find(name(i))) << i;
}

TEST_F(FullShellCache, KeepsTheOldestWhenItWasUsedLately) {
  EXPECT_TRUE(cache_.find(name(0)));
  cache_.keep(name(3), points_);
  EXPECT_TRUE(cache_.find(name(0)));
  EXPECT_FALSE(cache_.find(name(1)));
}

TEST_F(FullShellCache, DoesNotTakeAShellThatIsTooLarge) {
  cache_.keep("large", random_points(1000));
  EXPECT_FALSE(cache_.find("large"));
  EXPECT_EQ(cache_.contents().shells, 3u);
}

TEST_F(FullShellCache, LeavesFilesThatAreNotItsOwn) {
  write_plainly(directory_ / "thesis.txt", std::string(10 * one_, 'x'));
  cache_.keep(name(3), points_);
  EXPECT_TRUE(fs::exists(directory_ / "thesis.txt"));
  EXPECT_EQ(cache_.contents().shells, 3u);
}

TEST(ShellCacheLocation, IsTheFirstOfThreeVariables) {
  const test::EnvironmentVariable home("HOME", "/home/somebody");
  const test::EnvironmentVariable xdg("XDG_CACHE_HOME", "/caches");
  {
    const test::EnvironmentVariable chosen("HAPBENCH_CACHE_DIR", "relative/is fine");
    EXPECT_EQ(shell_cache_directory(), "relative/is fine");
  }
  const test::EnvironmentVariable not_chosen("HAPBENCH_CACHE_DIR", std::nullopt);
  EXPECT_EQ(shell_cache_directory(), "/caches/hapbench");
  for (const std::optional<std::string>& none : {std::optional<std::string>(), {""}, {"relative/is void"}}) {
    const test::EnvironmentVariable no_xdg("XDG_CACHE_HOME", none);
    EXPECT_EQ(shell_cache_directory(), "/home/somebody/.cache/hapbench");
    const test::EnvironmentVariable homeless("HOME", none);
    EXPECT_EQ(shell_cache_directory(), "");
  }
}

TEST(ShellCacheLocation, IsNowhereWhenChosenEmpty) {
  const test::EnvironmentVariable chosen("HAPBENCH_CACHE_DIR", "");
  EXPECT_EQ(shell_cache_directory(), "");
}

}  // namespace
}  // namespace hapbench
