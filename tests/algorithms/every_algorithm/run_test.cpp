// Whole runs of every algorithm: the tool is let go in the scene.
#include "tests/algorithms/every_algorithm/algorithm_on_scene.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::run_test {
namespace {

constexpr std::uint64_t kSteps = 200;

class Run : public test::AlgorithmOnSceneTest {};
HAPBENCH_FOR_EVERY_ALGORITHM(Run, test::always);

TEST_P(Run, StaysFinite) {
  test::Recorder recorder(true);
  Simulation simulation(test::free_run_config(setting, config, kSteps), test::free_run(setting, config), {&recorder});
  EXPECT_EQ(simulation.run().outcome, Outcome::completes);
  for (const StepRecord& row : recorder.rows) {
    ASSERT_TRUE(row.force.rendered.allFinite());
    ASSERT_TRUE(row.force.S.allFinite());
    ASSERT_TRUE(std::isfinite(row.ratio.min) && std::isfinite(row.ratio.max));
    // No law adds contacts. The proxy is held by points that the tool itself need not touch.
    if (GetParam().algorithm != "proxy") {
      ASSERT_LE(recorder.rendered[row.step], row.colliding);
    }
  }
}

TEST_P(Run, IsTheSameToTheBitAfterResetAndInAnotherObject) {
  test::HashingObserver hash;
  Simulation simulation(test::free_run_config(setting, config, kSteps), test::free_run(setting, config), {&hash});
  simulation.run();
  const std::uint64_t first = hash.value();

  hash.clear();
  simulation.reset();
  simulation.run();
  EXPECT_EQ(hash.value(), first);

  hash.clear();
  Simulation(test::free_run_config(setting, config, kSteps), test::free_run(setting, config), {&hash}).run();
  EXPECT_EQ(hash.value(), first);
}

TEST_P(Run, WithReductionAndLocalAverageIsTheSameToTheBitAfterReset) {
  config.reduction = ReductionConfig{0.995, 3, 42};
  config.local_average = !setting.springs;
  test::HashingObserver hash;
  Simulation simulation(test::free_run_config(setting, config, kSteps), test::free_run(setting, config), {&hash});
  simulation.run();
  const std::uint64_t first = hash.value(), dropped = simulation.algorithm().work().points_dropped;
  hash.clear();
  simulation.reset();
  simulation.run();
  EXPECT_EQ(hash.value(), first);
  EXPECT_EQ(simulation.algorithm().work().points_dropped, dropped);
}

}  // namespace
}  // namespace hapbench::run_test
