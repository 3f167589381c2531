#include "scenarios/cases/comparison.hpp"

#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"

namespace hapbench::result_folders_test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class EarlierResults : public testing::Test {
 protected:
  void write(const std::string& name) const {
    fs::create_directories((out_ / name).parent_path());
    test::write_plainly(out_ / name, "x");
  }
  void write_run(const std::string& directory) const {
    for (const char* file : {"summary.json", "scenario.effective.json", "trajectory.csv"}) {
      write(directory + "/" + file);
    }
  }
  /// The files except for the list itself.
  Names names() const {
    Names names = test::names_below(out_);
    std::erase(names, kResultListFile);
    return names;
  }
  test::TemporaryDirectory directory_;
  fs::path out_ = directory_ / "out";
};

TEST_F(EarlierResults, AreRemovedWhereTheyAreNotWrittenAnew) {
  fs::create_directory(out_);
  replace_earlier_results(out_, {{"a/mean/seed_0", "a/proxy", "mean"}, {"a/comparison.csv", "league.csv"}});
  for (const char* run : {"a/mean/seed_0", "a/proxy", "mean"}) write_run(run);
  for (const char* table : {"a/comparison.csv", "league.csv"}) write(table);
  replace_earlier_results(out_, {{"mean"}, {"comparison.csv"}});
  EXPECT_EQ(names(), (Names{"mean/scenario.effective.json", "mean/summary.json", "mean/trajectory.csv"}));
  EXPECT_FALSE(fs::exists(out_ / "a"));
}

TEST_F(EarlierResults, OutsideTheFolderAreNotTouched) {
  fs::create_directory(out_);
  fs::create_directory(directory_ / "mine");
  test::write_plainly(directory_ / "mine/summary.json", "x");
  test::write_plainly(directory_ / "league.csv", "x");
  fs::create_directory_symlink(directory_ / "mine", out_ / "link");
  fs::create_directory_symlink(directory_.path(), out_ / "up");
  const std::string absolute = (directory_ / "mine").string();
  test::write_plainly(out_ / kResultListFile, R"({"runs": ["../mine", "link", "up/mine", ")" + absolute +
                                                  R"(", "", ".", 5], "tables": ["../league.csv", "up/league.csv"]})");
  replace_earlier_results(out_, {});
  EXPECT_TRUE(fs::exists(directory_ / "mine/summary.json"));
  EXPECT_TRUE(fs::exists(directory_ / "league.csv"));
}

TEST_F(EarlierResults, AreNoneWhereTheListCannotBeRead) {
  fs::create_directory(out_);
  write_run("mean");
  for (const char* text : {"", "{", "[]", R"({"runs": "mean"})"}) {
    test::write_plainly(out_ / kResultListFile, text);
    replace_earlier_results(out_, {});
    EXPECT_EQ(names().size(), 3u) << text;
  }
}

}  // namespace
}  // namespace hapbench::result_folders_test
