#include "scenarios/analysis/stability/motion_classifier.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace hapbench::motion_classifier_test {
namespace {

constexpr std::uint64_t kSteps = 4000;

/// Returns the class of a tool whose velocity at step k is velocity(k) [m/s].
MotionClass class_by(MotionClassifier classifier, const std::function<Vec3(double k)>& velocity) {
  StepRecord record;
  for (record.step = 0; record.step < kSteps; ++record.step) {
    record.tool.velocity = velocity(static_cast<double>(record.step));
    classifier.on_step(record);
  }
  return classifier.motion_class(Ending::completed);
}

/// Returns the class of a tool that moves along x with velocity(k) [m/s].
MotionClass class_of(const std::function<double(double k)>& velocity) {
  return class_by(MotionClassifier(kSteps), [&](double k) { return Vec3(velocity(k), 0.0, 0.0); });
}

TEST(MotionClassifier, OfNoMotionAndOfCreepingIsStable) {
  EXPECT_EQ(class_of([](double) { return 0.0; }), MotionClass::stable);
  EXPECT_EQ(class_of([](double) { return 1.0; }), MotionClass::stable);
  EXPECT_EQ(class_of([](double k) { return std::exp(-0.0001 * k); }), MotionClass::stable)
      << "slow, but no oscillation";
  EXPECT_EQ(class_of([](double k) { return 1.0 + 0.001 * k; }), MotionClass::stable) << "falls, but does not oscillate";
}

// Checks a handle that moves slowly and whose encoder makes the measured velocity jump.
TEST(MotionClassifier, OfAHandleThatMovesTheToolTakesItsOwnVelocity) {
  MotionClassifier classifier(kSteps);
  StepRecord record;
  record.handle_moves_tool = true;
  for (record.step = 0; record.step < kSteps; ++record.step) {
    record.tool.velocity = Vec3(record.step % 2 == 0 ? 1.0 : -1.0, 0.0, 0.0);
    record.handle.velocity = Vec3(0.001, 0.0, 0.0);
    classifier.on_step(record);
  }
  EXPECT_EQ(classifier.motion_class(Ending::completed), MotionClass::stable);
}

/// Returns the class of an oscillation whose amplitude changes by the factor `per_step` in every step. The amplitude of
/// the fourth quarter is the amplitude of the first quarter times per_step^(3/4 kSteps). The oscillation has a period
/// of 10 steps. Its phase at the beginning of a quarter changes the amplitude of the quarter by up to 1 %.
MotionClass class_of_oscillation(double per_step) {
  return class_of([&](double k) { return std::pow(per_step, k) * std::cos(0.2 * std::numbers::pi * k); });
}

TEST(MotionClassifier, SeparatesClassesByWhatIsLostInAQuarter) {
  const double hundredth = std::pow(0.01, 1.0 / (0.75 * kSteps)), tenth = std::pow(0.9, 4.0 / kSteps),
               growth = std::pow(1.01, 4.0 / kSteps);
  EXPECT_EQ(class_of_oscillation(1.0 - 1.1 * (1.0 - hundredth)), MotionClass::stable);
  EXPECT_EQ(class_of_oscillation(1.0 - 0.9 * (1.0 - hundredth)), MotionClass::dying_out);
  EXPECT_EQ(class_of_oscillation(1.0 - 1.1 * (1.0 - tenth)), MotionClass::dying_out);
  EXPECT_EQ(class_of_oscillation(1.0 - 0.9 * (1.0 - tenth)), MotionClass::vibrating);
  EXPECT_EQ(class_of_oscillation(1.0 + 0.8 * (growth - 1.0)), MotionClass::vibrating);
  EXPECT_EQ(class_of_oscillation(1.0 + 1.2 * (growth - 1.0)), MotionClass::diverged);
}

/// Returns the class of a tool that a hand moves back and forth along x, at 1 Hz and up to 20 mm/s. The tool also
/// vibrates along y with the velocity `amplitude` [m/s] and the frequency [Hz].
MotionClass class_of_moved_tool(double amplitude, double frequency) {
  constexpr double kStep = 0.0005, kTurn = 2.0 * std::numbers::pi * kStep;
  return class_by(MotionClassifier::of_moved_tool(kSteps, kStep, kSteps), [&](double k) {
    return Vec3(0.02 * std::cos(kTurn * k), amplitude * std::cos(kTurn * frequency * k), 0.0);
  });
}

TEST(MotionClassifier, OfAMovedToolSeesWhatNoHandDoesAndWhatOneFeels) {
  EXPECT_EQ(class_of_moved_tool(0.0, 0.0), MotionClass::stable) << "the hand alone";
  EXPECT_EQ(class_of_moved_tool(0.01, 200.0), MotionClass::vibrating);
  EXPECT_EQ(class_of_moved_tool(0.0005, 200.0), MotionClass::stable) << "half a millimetre a second is not felt";
  EXPECT_EQ(class_of_moved_tool(0.01, 3.0), MotionClass::stable) << "a hand does that, too";
}

/// Returns the class of a tool that a hand moves along x at 20 mm/s during the first quarter of the run, and holds
/// afterwards. An oscillation at 12 Hz, which may decay, is added to the velocity. `amplitude` [m/s], `decay` [1/s],
/// `still`: the step in which the script of the motion ends.
MotionClass class_of_swinging_tool(double amplitude, double decay, double still) {
  constexpr double kStep = 0.0005, kTurn = 2.0 * std::numbers::pi * kStep;
  return class_by(MotionClassifier::of_moved_tool(kSteps, kStep, still), [&](double k) {
    const double led = k < kSteps / 4 ? 0.02 : 0.0;
    return Vec3(led + amplitude * std::exp(-decay * kStep * k) * std::cos(12.0 * kTurn * k), 0.0, 0.0);
  });
}

TEST(MotionClassifier, OfAScriptThatHasEndedSeesSlowSwingingToo) {
  EXPECT_EQ(class_of_swinging_tool(0.01, 0.0, kSteps), MotionClass::stable) << "a script that goes on may swing itself";
  EXPECT_EQ(class_of_swinging_tool(0.01, 0.0, kSteps / 4), MotionClass::vibrating);
  EXPECT_EQ(class_of_swinging_tool(0.0005, 0.0, kSteps / 4), MotionClass::stable) << "not felt";
  EXPECT_EQ(class_of_swinging_tool(0.0, 0.0, kSteps / 4), MotionClass::stable);
  const double length = 0.0005 * kSteps;
  const MotionClass dying = class_of_swinging_tool(0.01, 2.0 / length, kSteps / 4);
  EXPECT_TRUE(dying == MotionClass::stable || dying == MotionClass::dying_out);
}

TEST(MotionClassifier, OfALimitCycleIsVibratingHoweverItBegan) {
  EXPECT_EQ(class_of([](double k) { return std::min(1.0, 0.001 * k) * std::sin(k); }), MotionClass::vibrating);
  EXPECT_EQ(class_of([](double k) { return (1.0 + 9.0 * std::exp(-0.01 * k)) * std::sin(k); }), MotionClass::vibrating);
}

TEST(MotionClassifier, IsAtRestOnlyAfterManyQuietRows) {
  MotionClassifier classifier(kSteps);
  StepRecord record;
  const auto see = [&](double speed, int rows) {
    for (int i = 0; i < rows; ++i, ++record.step) {
      record.tool.velocity = Vec3(speed, 0.0, 0.0);
      classifier.on_step(record);
    }
  };
  see(1.0, 1);
  see(1e-13, 199);
  EXPECT_FALSE(classifier.at_rest());
  see(1e-11, 1);  // not slow enough: the count of resting steps starts again
  see(1e-13, 199);
  EXPECT_FALSE(classifier.at_rest());
  see(1e-13, 1);
  EXPECT_TRUE(classifier.at_rest());
}

}  // namespace
}  // namespace hapbench::motion_classifier_test
