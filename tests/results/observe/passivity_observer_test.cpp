#include "results/observe/passivity_observer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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
  EXPECT_EQ(told(observer, "energy_min_J"), -3.0);
  EXPECT_EQ(told(observer, "time_of_min_s"), 1.0);  // the first of two
  EXPECT_EQ(told(observer, "energy_end_J"), -3.0);
  EXPECT_EQ(told(observer, "net_created_J"), 3.0);
}

TEST(PassivityObserver, OfSeveralTrialsTheOneThatCreatedMostCounts) {
  SimulationConfig config;
  config.dt = kDt;
  const SimulationParts parts = test::fake_parts([](const ToolState&) { return Vec3::Zero(); });
  PassivityObserver observer;
  EXPECT_FALSE(told(observer, "energy_min_J"));
  // Without rows; least energies of -1, -3 and -3 J, which end with -1, -2 and -3 J.
  for (const std::vector<double>& forces : std::vector<std::vector<double>>{{}, {2, 0}, {4, 2, -2, 0}, {6, 0}}) {
    observer.begin({config, parts});
    for (std::uint64_t k = 0; k < forces.size(); ++k) observer.on_step(row(k, forces[k]));
  }
  EXPECT_EQ(told(observer, "energy_min_J"), -3.0);
  EXPECT_EQ(told(observer, "time_of_min_s"), 1.0);
  EXPECT_EQ(told(observer, "energy_end_J"), -2.0);
  EXPECT_EQ(observer.net_created(), 3.0) << "of the last trial";
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
  EXPECT_GT(observer.net_created(), 1e-3);
  EXPECT_EQ(observer.net_created(), -observer.energy().value());
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
