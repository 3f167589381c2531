#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <string>
#include <thread>

#include "scenarios/input/text_file.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::text_file_test {
namespace {

TEST(ReadTextFile, RefusesANameThatTheSystemWouldCut) {
  EXPECT_TRUE(test::input_error_of([] { read_text_file(std::string("/dev/null\0more", 14), 100); }));
}

TEST(ReadTextFile, ReadsUpToItsLimitAndNoFurther) {
  const test::TemporaryDirectory directory;
  const std::string contents(1 << 20, 'x');
  test::write_plainly(directory / "file", contents);
  EXPECT_EQ(read_text_file(directory / "file", contents.size()), contents);
  const auto refusal = test::input_error_of([&] { read_text_file(directory / "file", contents.size() - 1); });
  ASSERT_TRUE(refusal);
  EXPECT_NE(refusal->problem().find("is larger than"), std::string::npos);
  // A device without an end also stops at the limit.
  EXPECT_TRUE(test::input_error_of([] { read_text_file("/dev/zero", 1 << 20); }));
}

/// A second read would wait for a writer forever.
TEST(ReadTextFile, ReadsAPipeOnceAndKeepsItsContents) {
  const test::TemporaryDirectory directory;
  const auto pipe = directory / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(pipe) << "contents"; });
  EXPECT_EQ(read_text_file(pipe, 100), "contents");
  writer.join();
  EXPECT_EQ(read_text_file(pipe, 100), "contents");
}

}  // namespace
}  // namespace hapbench::text_file_test
