#include "results/io/new_directories.hpp"

#include <gtest/gtest.h>

#include "tests/results/files.hpp"

namespace hapbench::new_directories_test {
namespace {

namespace fs = std::filesystem;

TEST(NewDirectories, RemovesWhatItMadeAndNobodyUsed) {
  const test::TemporaryDirectory directory;
  fs::create_directory(directory / "mine");
  {
    NewDirectories made;
    std::error_code error;
    for (const char* name : {"a/b/c", "a/used", "mine", "mine/below"}) {
      made.create(directory / name, error);
      EXPECT_FALSE(error) << name;
      EXPECT_TRUE(fs::is_directory(directory / name)) << name;
    }
    test::write_plainly(directory / "a/used/file", "x");
  }
  EXPECT_TRUE(fs::exists(directory / "a/used/file"));
  EXPECT_FALSE(fs::exists(directory / "a/b"));
  EXPECT_TRUE(fs::exists(directory / "mine")) << "empty, but not its own";
  EXPECT_FALSE(fs::exists(directory / "mine/below"));
}

TEST(NewDirectories, SaysWhenItCannot) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "file", "mine");
  {
    NewDirectories made;
    std::error_code error;
    made.create(directory / "file/below", error);
    EXPECT_TRUE(error);
  }
  EXPECT_EQ(test::read_file(directory / "file"), "mine");
}

}  // namespace
}  // namespace hapbench::new_directories_test
