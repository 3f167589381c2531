#include "scenarios/input/child_process.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <new>
#include <stdexcept>
#include <vector>

#include "tests/support/scale.hpp"

namespace hapbench {
namespace {

using End = ChildAnswer::End;

End end_of(const std::function<std::string()>& work, const ChildLimits& limits = {}) {
  const ChildAnswer answer = answer_of_child(work, limits);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
  return answer.end;
}

TEST(AnswerOfChild, IsWhatTheWorkReturns) {
  // Longer than a pipe holds, with every byte.
  std::string bytes;
  for (int i = 0; i < 1'000'000; ++i) bytes += static_cast<char>(i);
  const ChildAnswer answer = answer_of_child([&] { return bytes; }, {});
  EXPECT_EQ(answer.end, End::answered);
  EXPECT_EQ(answer.bytes, bytes);
  EXPECT_EQ(answer_of_child([] { return std::string(); }, {}).end, End::answered);
}

TEST(AnswerOfChild, TellsHowTheWorkFailed) {
  EXPECT_EQ(end_of([]() -> std::string { throw std::runtime_error("x"); }), End::failed);
  EXPECT_EQ(end_of([]() -> std::string { throw std::bad_alloc(); }), End::too_large);
  EXPECT_EQ(end_of([]() -> std::string {
              ::kill(::getpid(), SIGKILL);
              return "";
            }),
            End::crashed);
  EXPECT_EQ(end_of([]() -> std::string { std::abort(); }), End::crashed);
  EXPECT_EQ(end_of([]() -> std::string { ::_exit(77); }), End::crashed);
}

TEST(AnswerOfChild, EndsWorkThatWaitsOrTalksTooMuch) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(end_of(
                []() -> std::string {
                  ::pause();
                  return "";
                },
                {.wall_seconds = 1}),
            End::too_slow);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  EXPECT_EQ(end_of([] { return std::string(3'000'000, 'x'); }, {.answer = 1'000'000}), End::too_large);
}

TEST(AnswerOfChild, EndsWorkThatUsesUpItsProcessorTime) {
  const auto spin = []() -> std::string {
    for (volatile bool on = true; on;) continue;
    return "";
  };
  EXPECT_EQ(end_of(spin, {.cpu_seconds = 1}), End::too_slow);
}

TEST(AnswerOfChild, EndsWorkThatEatsMemory) {
  if (HAPBENCH_TEST_SANITIZED != 0) GTEST_SKIP() << "sanitizers reserve more than any limit";
  const auto eat = []() -> std::string {
    std::vector<std::string> eaten;
    for (;;) eaten.emplace_back(1 << 20, 'x');
  };
  EXPECT_EQ(end_of(eat, {.cpu_seconds = 60, .memory = std::size_t{1} << 28}), End::too_large);
}

TEST(AnswerOfChild, KeepsWhatTheWorkPrintsToItself) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  std::printf("in a buffer of the parent ");
  EXPECT_EQ(end_of([] {
              std::fputs("from the child", stderr);
              std::fputs("from the child", stdout);
              std::fflush(stdout);
              return std::string();
            }),
            End::answered);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "in a buffer of the parent ");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace hapbench
