#include "tests/scenarios/program/bad_inputs.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/support/scale.hpp"

/// Every bad input, given to the real program: exit status 2, one line on standard error that names file, place and
/// what is allowed, nothing written, soon, in bounded memory.
namespace hapbench::bad_input_test {
namespace {

namespace fs = std::filesystem;
using test::BadInput;

/// Processor time within which bad input must be refused: two seconds as people run it; code that is not optimised or
/// is sanitized is up to thirty times slower.
#if defined(__OPTIMIZE__) && !HAPBENCH_TEST_SANITIZED
constexpr double kMostSeconds = 2.0;
#else
constexpr double kMostSeconds = 60.0;
#endif
/// Address space it may take: the largest file read is 64 MiB, and 16 bytes a value of it are a gigabyte.
constexpr std::size_t kMostMemory = HAPBENCH_TEST_SANITIZED ? 0 : std::size_t{3} << 30;

class BadInputs : public testing::TestWithParam<BadInput> {};

/// A line for each fault, the first of which says all it must.
void expect_message(const std::string& err, const std::string& file, const BadInput& input) {
  ASSERT_FALSE(err.empty());
  EXPECT_EQ(err.back(), '\n');
  EXPECT_LT(err.size(), 10'000u);
  const std::vector<std::string> lines = test::lines_of(err);
  ASSERT_EQ(lines.size(), input.faults) << err;
  for (const std::string& line : lines) {
    for (const char c : line) ASSERT_FALSE(static_cast<unsigned char>(c) < 0x20) << "control character";
    EXPECT_EQ(line.find("hapbench: error: " + file + ": "), 0u) << line;
  }
  // hapbench: error: FILE: PLACE…: PROBLEM, or without a place for the whole file.
  const std::string begin = "hapbench: error: " + file + ": " + input.place;
  ASSERT_EQ(err.substr(0, begin.size()), begin) << err;
  EXPECT_NE(lines[0].find(input.says, begin.size()), std::string::npos) << "no \"" << input.says << "\" in " << err;
}

TEST_P(BadInputs, IsRefusedInOneLineAndNothingIsWritten) {
  const BadInput& input = GetParam();
  const test::TemporaryDirectory directory;
  const fs::path scenario = directory / "bad input.json", output = directory / "out/below";
  test::write_plainly(scenario, input.make != nullptr ? input.make() : input.scenario);
  for (const auto& [name, contents] : input.files) {
    fs::create_directories((directory.path() / name).parent_path());
    test::write_plainly(directory.path() / name, contents);
  }
  const auto before = test::names_below(directory.path());

  test::ProgramOptions options;
  options.memory_limit = kMostMemory;
  const test::ProgramRun run = test::hapbench({"run", scenario.string(), "--out", output.string()}, options);

  EXPECT_EQ(run.signal, 0);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_LT(run.cpu_seconds, kMostSeconds);
  expect_message(run.err, scenario.string(), input);
  EXPECT_FALSE(fs::exists(directory / "out"));
  EXPECT_EQ(test::names_below(directory.path()), before);
}

std::string name_of_case(const testing::TestParamInfo<BadInput>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Texts, BadInputs, testing::ValuesIn(test::malformed_texts()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Values, BadInputs, testing::ValuesIn(test::wrong_values()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Structures, BadInputs, testing::ValuesIn(test::wrong_structures()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Contradictions, BadInputs, testing::ValuesIn(test::contradictions()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Sizes, BadInputs, testing::ValuesIn(test::absurd_sizes()), name_of_case);
INSTANTIATE_TEST_SUITE_P(ShellFiles, BadInputs, testing::ValuesIn(test::bad_shell_files()), name_of_case);
INSTANTIATE_TEST_SUITE_P(MeshFiles, BadInputs, testing::ValuesIn(test::bad_mesh_files()), name_of_case);
INSTANTIATE_TEST_SUITE_P(MotionFiles, BadInputs, testing::ValuesIn(test::bad_motion_files()), name_of_case);

/// A scenario argument that is no readable file.
class BadScenarioArgument : public testing::Test {
 protected:
  std::string refusal_of(const std::string& argument) const {
    const test::ProgramRun run = test::hapbench({"run", argument, "--out", (directory_ / "out").string()});
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(fs::exists(directory_ / "out"));
    return run.err;
  }
  test::TemporaryDirectory directory_;
};

TEST_F(BadScenarioArgument, ThatIsADirectoryIsRefused) {
  EXPECT_EQ(refusal_of(directory_.path().string()),
            "hapbench: error: " + directory_.path().string() + ": is a directory, not a file\n");
}

TEST_F(BadScenarioArgument, ThatNamesNothingGetsTheNearestBundledName) {
  EXPECT_EQ(refusal_of("peg_in_hole_2d_meen"),
            "hapbench: error: peg_in_hole_2d_meen: no such file and no bundled scenario; nearest valid name: "
            "\"peg_in_hole_2d_mean\"; \"hapbench list\" shows them\n");
  EXPECT_NE(refusal_of((directory_ / "missing.json").string()).find("no such file"), std::string::npos);
  refusal_of("");
  refusal_of("two\nlines");
}

TEST_F(BadScenarioArgument, AmongGoodOnesStopsThemAll) {
  test::write_plainly(directory_ / "bad.json", "{}");
  const test::ProgramRun run = test::hapbench(
      {"run", "single_spring", (directory_ / "bad.json").string(), "--out", (directory_ / "out").string()});
  EXPECT_EQ(run.status, 2);
  EXPECT_FALSE(fs::exists(directory_ / "out"));
}

}  // namespace
}  // namespace hapbench::bad_input_test
