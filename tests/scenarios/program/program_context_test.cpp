#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/program/program_context.hpp"
#include "scenarios/program/results_folder.hpp"
#include "scenarios/program/run_program.hpp"
#include "tests/results/files.hpp"

/// Tests that several programs in one process, such as in a Python interpreter, share no state.
namespace hapbench::program_context_test {
namespace {

/// Returns the output of a command that runs inside a host program. Precondition: the command succeeds.
std::string text_of(const ProgramArguments& words) {
  CapturedOutput output;
  ProgramContext context{.program = "/some/where/hapbench", .captured = &output};
  EXPECT_EQ(run_program(words, context), kSuccess);
  return output.text;
}

TEST(ProgramContext, CollectsWhatACommandPrints) {
  testing::internal::CaptureStdout();
  EXPECT_NE(text_of({"describe", "algorithms"}).find("shaped_stiffness"), std::string::npos);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(ProgramContext, HasTheFileThatPrintedCommandsName) {
  const std::string text = text_of({"sweep", "single_spring", "--vary", "seed=1,2", "--row", "1", "--print"});
  EXPECT_TRUE(text.starts_with("/some/where/hapbench run ")) << text;
}

TEST(ProgramContext, KeepsTheWidthOfOneCommandFromTheNext) {
  ::setenv("COLUMNS", "60", 1);
  const std::string narrow = text_of({"describe", "algorithms"});
  const std::string wide = text_of({"describe", "algorithms", "--wide"});
  EXPECT_NE(narrow, wide);
  EXPECT_EQ(text_of({"describe", "algorithms"}), narrow);
  ::unsetenv("COLUMNS");
}

TEST(ProgramContext, RemovesTheNewFoldersThatAreStillEmpty) {
  const test::TemporaryDirectory directory;
  {
    ProgramContext context;
    require_writable_directory(context, directory / "empty" / "inner");
    require_writable_directory(context, directory / "used");
    test::write_plainly(directory / "used" / "file", "");
    EXPECT_TRUE(std::filesystem::exists(directory / "empty" / "inner"));
  }
  EXPECT_FALSE(std::filesystem::exists(directory / "empty"));
  EXPECT_TRUE(std::filesystem::exists(directory / "used"));
}

}  // namespace
}  // namespace hapbench::program_context_test
