#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// The command line itself, and where results may go.
namespace hapbench::usage_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::ProgramRun;

TEST(Usage, ErrorsExitWith2AndSayWhatIsWrongOnStandardError) {
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"fly"},
                                                       {"run"},
                                                       {"compare"},
                                                       {"stability"},
                                                       {"shell"},
                                                       {"sweep"},
                                                       {"sweep", "single_spring"},
                                                       {"sweep", "single_spring", "--vary"},
                                                       {"diff"},
                                                       {"diff", "x"},
                                                       {"sweep", "single_spring", "--vary", "seed=1", "--jobs", "x"},
                                                       {"merge"},
                                                       {"merge", "x.csv"},
                                                       {"describe"},
                                                       {"validate"},
                                                       {"--no-such-option"},
                                                       {"run", "single_spring", "--outt", "x"},
                                                       {"run", "single_spring", "--out"},
                                                       {"run", "single_spring", "--set"},
                                                       {"compare", "single_spring", "--algorithms"},
                                                       {"compare", "single_spring", "mean"},
                                                       {"list", "more"},
                                                       {"describe", "a", "b"},
                                                       {"run", "single_spring", "list"}};
  const test::TemporaryDirectory directory;
  test::ProgramOptions options;
  options.directory = directory.path();
  for (const auto& arguments : wrong) {
    const ProgramRun run = hapbench(arguments, options);
    std::string words;
    for (const std::string& word : arguments) words += word + " ";
    EXPECT_EQ(run.status, 2) << words;
    EXPECT_EQ(run.out, "") << words;
    EXPECT_NE(run.err, "") << words;
  }
  EXPECT_EQ(directory.entries(), std::vector<std::string>{});
}

// A study run twice would write the same files twice.
TEST(Usage, TakesEachPrecisionStudyOnce) {
  const auto refusal = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "precision");
    const ProgramRun run = hapbench(arguments);
    EXPECT_EQ(run.status, 2);
    return run.err;
  };
  EXPECT_EQ(refusal({"shaping", "shaping"}), "hapbench: error: got study \"shaping\" twice; allowed: once\n");
  EXPECT_EQ(refusal({"all", "shaping"}),
            "hapbench: error: got study \"all\" beside other names; allowed: \"all\" alone\n");
  EXPECT_NE(refusal({"shapin"}).find("got study \"shapin\"; allowed: \"all\", "), std::string::npos);
}

TEST(Usage, HelpExitsWith0AndNamesTheCommandsAndExitStatuses) {
  const ProgramRun run = hapbench({"--help"});
  EXPECT_EQ(run.status, 0);
  for (const char* word : {"run", "compare", "stability", "sweep", "merge", "diff", "shell", "list", "describe",
                           "validate", "Exit status"}) {
    EXPECT_NE(run.out.find(word), std::string::npos) << word;
  }
  for (const char* command :
       {"run", "compare", "stability", "sweep", "merge", "diff", "shell", "list", "describe", "validate"}) {
    const ProgramRun help = hapbench({command, "--help"});
    EXPECT_EQ(help.status, 0) << command;
    EXPECT_NE(help.out.find("--quiet"), std::string::npos) << command;
    EXPECT_NE(help.out.find("--json"), std::string::npos) << command;
  }
}

TEST(Usage, PointsFromFieldsAndMeshesToWhatTakesThem) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "my.stl", "solid\n");
  test::write_plainly(directory / "mine.json", "{}");
  test::ProgramOptions options;
  options.directory = directory.path();
  for (const auto& [arguments, hint] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"run", "single_spring", "--stiffness", "5"}, "fields are set by --set FIELD=VALUE"},
           {{"sweep", "single_spring", "--grid", "5"}, "fields are varied by --vary FIELD=VALUES"},
           {{"run", "my.stl"}, "my.stl: is a mesh; allowed: a scenario, as \"hapbench new mesh --from my.stl\""},
           {{"compare", "mine"}, "there is mine.json"},
           {{"reproduce", "--only", "b9"}, "nearest valid name: \"B1\""}}) {
    const ProgramRun run = hapbench(arguments, options);
    EXPECT_EQ(run.status, 2) << hint;
    EXPECT_NE(run.err.find(hint), std::string::npos) << run.err;
  }
}

TEST(Usage, VersionIsPrinted) {
  const ProgramRun run = hapbench({"--version"});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out.find("hapbench "), 0u);
}

TEST(Usage, MalformedOverridesAreRefusedInOneLine) {
  for (const char* override : {"time.steps", "=5", "time.stepss=5", "environment.groups.7.count=1"}) {
    const ProgramRun run = hapbench({"run", "single_spring", "--set", override, "--out", "/nonexistent/never"});
    EXPECT_EQ(run.status, 2) << override;
    EXPECT_EQ(test::lines_of(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find("allowed"), std::string::npos) << run.err;
  }
}

class OutputDirectory : public testing::Test {
 protected:
  static std::vector<std::vector<std::string>> commands_writing_to(const fs::path& out) {
    return {{"run", "single_spring", "--out", out.string()},
            {"run", "single_spring", "single_damper", "--out", out.string()},
            {"compare", "single_spring", "--algorithms", "mean", "--out", out.string()},
            {"stability", "single_spring", "--out", out.string()},
            {"sweep", "single_spring", "--vary", "seed=1,2", "--out", out.string()},
            {"shell", "peg_in_hole_2d_mean", "--out", (out / "s.csv").string()}};
  }
  static void expect_all_refused(const fs::path& out, const test::ProgramOptions& options = {}) {
    for (const auto& arguments : commands_writing_to(out)) {
      const ProgramRun run = hapbench(arguments, options);
      EXPECT_EQ(run.status, 2) << arguments[0] << " " << run.err;
      EXPECT_EQ(run.out, "") << arguments[0];
      EXPECT_EQ(test::lines_of(run.err).size(), 1u) << run.err;
      EXPECT_NE(run.err.find(out.string()), std::string::npos) << run.err;
    }
  }
  test::TemporaryDirectory directory_;
};

TEST_F(OutputDirectory, ThatIsAFileIsRefused) {
  test::write_plainly(directory_ / "file", "mine");
  expect_all_refused(directory_ / "file");
  EXPECT_EQ(test::read_file(directory_ / "file"), "mine");
}

TEST_F(OutputDirectory, BelowAFileIsRefused) {
  test::write_plainly(directory_ / "file", "mine");
  expect_all_refused(directory_ / "file/below");
}

TEST_F(OutputDirectory, ThatCannotBeCreatedIsRefused) {
  expect_all_refused("/proc/hapbench_cannot_write_here");
}

TEST_F(OutputDirectory, WithoutPermissionIsRefused) {
  fs::create_directory(directory_ / "locked");
  ::chmod((directory_ / "locked").c_str(), 0555);
  test::ProgramOptions options;
  options.as_root_may = false;
  if (hapbench({"list"}, options).status == 126) GTEST_SKIP() << "root's privileges cannot be dropped here";
  expect_all_refused(directory_ / "locked", options);
  expect_all_refused(directory_ / "locked/below", options);
  EXPECT_TRUE(fs::is_empty(directory_ / "locked"));
}

TEST_F(OutputDirectory, WithATooLongNameIsRefused) {
  expect_all_refused(directory_ / std::string(300, 'd'));
}

TEST_F(OutputDirectory, MayHaveSpacesQuotesAndLetters) {
  const fs::path out = directory_ / "a b/c'd\"e/\xc3\xa4$HOME;x";
  for (const auto& arguments : commands_writing_to(out)) {
    const ProgramRun run = hapbench(arguments);
    EXPECT_EQ(run.status, 0) << arguments[0] << run.err;
  }
  EXPECT_TRUE(fs::exists(out / "s.csv"));
}

}  // namespace
}  // namespace hapbench::usage_test
