#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::stress_command_test {
namespace {

TEST(StressCommand, CountsForcesOfEveryAlgorithm) {
  const test::TemporaryDirectory directory;
  const std::string out = (directory / "out").string();
  const test::ProgramRun run = test::hapbench({"stress", "--count", "2000", "--json", "--out", out});
  EXPECT_EQ(run.status, 0) << run.err;
  const Json json = run.json();
  EXPECT_EQ(json.size(), algorithms().size());
  for (const Json& counts : json) {
    EXPECT_EQ(counts["sets"], 2000);
    EXPECT_EQ(counts["non_finite"], 0);
    EXPECT_EQ(counts["out_of_bound"], 0);
    EXPECT_EQ(counts["first_bad_set"], nullptr);
  }
  EXPECT_EQ(test::lines_of(test::read_file(directory / "out/stress.csv")).size(), 1 + algorithms().size());
  // The seed decides.
  const auto text = [&](const char* seed) {
    return test::hapbench({"stress", "--count", "50", "--seed", seed, "--json", "--out", out}).out;
  };
  EXPECT_EQ(text("5"), text("5"));
  EXPECT_NE(text("5"), text("6"));
}

}  // namespace
}  // namespace hapbench::stress_command_test
