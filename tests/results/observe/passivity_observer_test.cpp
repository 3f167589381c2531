#include "results/observe/passivity_observer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "results/allocations/allocations.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::passivity_observer_test {
namespace {

constexpr double kDt = 0.5;

/// A row of a tool that moves along x at 1 m/s under this force.
StepRecord row(std::uint64_t step, double force) {
  StepRecord record;
  record.step = step;
  record.time = kDt * static_cast<double>(step);
  record.tool.velocity = {1, 0, 0};
  record.force.rendered = {force, 0, 0};
  return record;
}

TEST(PassivityObserver, FindsTheLeastEnergyAndItsTime) {
  PassivityObserver observer(kDt);
  // E: 0, -1 (2 N over 0.5 m), -3, -2, -3
  const double forces[] = {2, 4, -2, 2, 7};
  for (std::uint64_t k = 0; k < std::size(forces); ++k) observer.on_step(row(k, forces[k]));
  const PassivityMetrics m = *observer.metrics();
  EXPECT_EQ(m.energy_min, -3.0);
  EXPECT_EQ(m.time_of_min, 1.0);  // the first of two
  EXPECT_EQ(m.energy_end, -3.0);
  EXPECT_EQ(m.net_created(), 3.0);
}

TEST(PassivityObserver, WithoutRowsThereIsNothingToSay) {
  EXPECT_FALSE(PassivityObserver(kDt).metrics());
  EXPECT_FALSE(merged(std::vector<std::optional<PassivityMetrics>>{}));
  EXPECT_FALSE(merged(std::vector<std::optional<PassivityMetrics>>{std::nullopt}));
}

TEST(PassivityObserver, OfSeveralRunsTheOneThatCreatedMostCounts) {
  const auto all = merged(std::vector<std::optional<PassivityMetrics>>{PassivityMetrics{-1.0, 0.1, 5.0}, std::nullopt,
                                                                       PassivityMetrics{-2.0, 0.2, 6.0},
                                                                       PassivityMetrics{-2.0, 0.3, 7.0}});
  ASSERT_TRUE(all);
  EXPECT_EQ(all->energy_min, -2.0);
  EXPECT_EQ(all->time_of_min, 0.2);
  EXPECT_EQ(all->energy_end, 6.0);
}

/// A spring of negative stiffness drives the tool away from its middle: all its kinetic energy is from nothing.
TEST(PassivityObserver, ANegativeSpringCreatesTheKineticEnergy) {
  PassivityObserver observer(0.0005);
  SimulationConfig config;
  config.steps = 200;
  config.position = {0.001, 0, 0};
  Simulation simulation(config, test::fake_parts([](const ToolState& t) { return Vec3(500.0 * t.pose.position); }),
                        {&observer});
  simulation.run();
  // The run moves the tool on after the last row; the row's velocity is that before.
  const PassivityMetrics m = *observer.metrics();
  EXPECT_GT(m.net_created(), 1e-3);
  EXPECT_EQ(m.net_created(), -m.energy_end);
}

TEST(PassivityObserver, WantsSpringsOnlyAndAllocatesNothing) {
  PassivityObserver observer(kDt);
  EXPECT_TRUE(observer.wants_springs());
  EXPECT_FALSE(observer.wants_energy());
  const AllocationCount count;
  for (std::uint64_t k = 0; k < 100; ++k) observer.on_step(row(k, 1.0));
  EXPECT_EQ(count.value(), 0u);
}

}  // namespace
}  // namespace hapbench::passivity_observer_test
