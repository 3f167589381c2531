#include "scenarios/run/stop_signal.hpp"

#include <gtest/gtest.h>

#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::stop_signal_test {
namespace {

/// With SIGINT as a shell in the foreground leaves it; behind "&" it is ignored, and stays so.
class StopSignals : public testing::Test {
 protected:
  StopSignals() : before_(std::signal(SIGINT, SIG_DFL)) {}
  ~StopSignals() override { std::signal(SIGINT, before_); }

 private:
  void (*before_)(int);
};

TEST_F(StopSignals, AreRecordedAndForgotten) {
  {
    const StopSignal signals;
    EXPECT_EQ(StopSignal::received(), 0);
    EXPECT_NO_THROW(throw_if_stopped());
    std::raise(SIGTERM);
    EXPECT_EQ(StopSignal::received(), SIGTERM);
    try {
      throw_if_stopped();
      FAIL() << "nothing was thrown";
    } catch (const Stopped& stopped) {
      EXPECT_EQ(stopped.signal, SIGTERM);
    }
  }
  EXPECT_EQ(StopSignal::received(), 0);
}

TEST_F(StopSignals, EndARunOfWhichNothingIsLeft) {
  const test::TemporaryDirectory directory;
  LoadedScenario loaded = read_scenario(test::minimal_scenario("springs"), ".");
  for (const bool timed : {false, true}) {
    loaded.scenario.record.timing = timed;
    const StopSignal signals;
    std::raise(SIGINT);
    EXPECT_THROW(run_scenario(loaded, directory / "out/below", false), Stopped);
    EXPECT_EQ(directory.entries(), std::vector<std::string>{});
  }
  run_scenario(loaded, directory / "out/below", false);
  EXPECT_TRUE(std::filesystem::exists(directory / "out/below/summary.json"));
}

TEST_F(StopSignals, EndJobsThatDoNotAskForIt) {
  const StopSignal signals;
  std::size_t begun = 0;
  EXPECT_THROW(for_each_job(1000, {1, ""},
                            [&](std::size_t i) {
                              ++begun;
                              if (i == 10) std::raise(SIGINT);
                            }),
               Stopped);
  EXPECT_EQ(begun, 11u);
}

}  // namespace
}  // namespace hapbench::stop_signal_test
