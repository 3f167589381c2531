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
  // An endless file, such as /dev/zero, is also read only up to the limit.
  EXPECT_TRUE(test::input_error_of([] { read_text_file("/dev/zero", 1 << 20); }));
}

TEST(ReadTextFile, RefusesOtherEncodingsAndCompressedFiles) {
  const test::TemporaryDirectory directory;
  const auto problem_of = [&](const std::string& bytes) {
    test::write_plainly(directory / "file", bytes);
    const auto refusal = test::input_error_of([&] { read_text_file(directory / "file", 100); });
    return refusal ? refusal->problem() : "";
  };
  for (const std::string& text : {std::string("\xFF\xFEv\0 \0", 6), std::string("\xFE\xFF\0v\0 ", 6),
                                  std::string("v\0 \0", 4), std::string("\0v\0 ", 4)})
    EXPECT_EQ(problem_of(text).find("is a text in UTF-16 or UTF-32; allowed: UTF-8"), 0u);
  for (const char* start : {"\x1F\x8B\x08", "PK\x03\x04", "BZh91AY&SY", "\xFD\x37zXZ", "\x28\xB5\x2F\xFD"})
    EXPECT_EQ(problem_of(start).find("is compressed; allowed: the unpacked file"), 0u) << start;
  for (const std::string& other : {std::string("v 0 0 0\n"), std::string("v\0\0\0", 4), std::string("BZh")}) {
    test::write_plainly(directory / "file", other);
    EXPECT_EQ(read_text_file(directory / "file", 100), other);
  }
}

/// Checks that a pipe is read only once. A second read would wait for a writer forever.
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
