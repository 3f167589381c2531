#include "sim/loop/observed_energy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/fakes.hpp"

namespace hapbench::observed_energy_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kDt = 0.001, kMass = 0.2, kK = 5000.0;

/// One spring and damper along x under leapfrog, observed for `rows` rows; the tool afterwards.
ToolState run_spring(ObservedEnergy& observed, double damping, double position, double velocity, int rows) {
  ToolState tool{{{position, 0, 0}, {0, 0, -1}}, {velocity, 0, 0}};
  for (int k = 0; k < rows; ++k) {
    const double x = tool.pose.position.x();
    observed.move(tool);
    const Vec3 force{-kK * x - damping * tool.velocity.x(), 0, 0};
    observed.answer(tool, force, {0.5 * kK * x * x, Vec3::Zero()});
    if (k + 1 < rows) test::leapfrog(tool, force, kMass, kDt);
  }
  return tool;
}

/// Work is what the force adds to the kinetic energy, so E_n - E_0 is what the tool has lost.
TEST(ObservedEnergy, IsWhatALoneToolHasLost) {
  ObservedEnergy observed(kDt);
  const ToolState end = run_spring(observed, 20.0, 0.003, 0.4, 300);
  const double given = 0.5 * kK * 0.003 * 0.003 + 0.5 * kMass * 0.4 * 0.4;
  EXPECT_NEAR(observed.energy(), given - 0.5 * kMass * end.velocity.squaredNorm(), 300 * 10 * kEpsilon * given);
}

/// Half of a turn belongs to the row before, half to the row after: the trapezoidal rule.
TEST(ObservedEnergy, AMomentThatAppearsOrGoesCountsForHalfATurn) {
  ObservedEnergy observed(kDt);
  double angle = 0.0;
  const auto row = [&](double moment) {
    ToolState tool;
    tool.pose.axis = {std::sin(angle), 0, -std::cos(angle)};
    observed.move(tool);
    observed.answer(tool, Vec3::Zero(), {0.0, {0, moment, 0}});
    angle += 0.1;
  };
  row(0.0);
  row(0.0);
  EXPECT_EQ(observed.energy(), 0.0);
  row(4.0);
  EXPECT_NEAR(observed.energy(), 0.2, 1e-15);
  row(0.0);
  EXPECT_NEAR(observed.energy(), 0.4, 1e-15);
  row(0.0);
  EXPECT_NEAR(observed.energy(), 0.4, 1e-15);
}

/// A moment after a rest is turned against from the row before, as without the short cut.
TEST(ObservedEnergy, ARowOfRestIsARowWithoutForceAndMoment) {
  ObservedEnergy resting(kDt), asked(kDt);
  for (int k = 0; k < 30; ++k) {
    ToolState tool{{Vec3::Zero(), {std::sin(0.1 * k), 0, -std::cos(0.1 * k)}}, {1.0, 0.1 * k, 0}};
    const bool acts = k % 7 == 3 || k % 7 == 4;
    const Vec3 force = acts ? Vec3(2, 1, 0) : Vec3(0, 0, 0);
    const SpringState springs{0.0, acts ? Vec3(0, 1.0 + k, 0) : Vec3(0, 0, 0)};
    EXPECT_EQ(resting.rests(force, springs), k != 0 && !acts && k % 7 != 5);
    if (resting.rests(force, springs)) {
      resting.rest(tool);
    } else {
      resting.move(tool);
      resting.answer(tool, force, springs);
    }
    asked.move(tool);
    asked.answer(tool, force, springs);
    EXPECT_EQ(resting.energy(), asked.energy());
  }
}

TEST(ObservedEnergy, ResetForgetsEverything) {
  ObservedEnergy observed(kDt), fresh(kDt);
  run_spring(observed, 3.0, 0.01, -0.2, 50);
  observed.reset();
  run_spring(observed, 1.0, 0.002, 0.1, 50);
  run_spring(fresh, 1.0, 0.002, 0.1, 50);
  EXPECT_EQ(observed.energy(), fresh.energy());
}

}  // namespace
}  // namespace hapbench::observed_energy_test
