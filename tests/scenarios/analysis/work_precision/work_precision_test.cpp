#include "scenarios/analysis/work_precision/work_precision.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::work_precision_test {
namespace {

constexpr double kStep = 1e-3, kStiffness = 1000.0, kMass = 0.1, kStart = 1e-3;
constexpr int kSteps = 64;

/// Returns the scenario of a mass on one bilateral spring without damping: x(t) = x_0 cos(omega t).
ScenarioText oscillator() {
  return {test::data_directory() / "oscillator.json",
          Json{{"time", {{"step_s", kStep}, {"steps", kSteps}}},
               {"environment", {{"type", "springs"}, {"groups", {{{"direction", {1, 0, 0}}, {"count", 1}}}}}},
               {"initial", {{"position_m", {kStart, 0, 0}}}},
               {"rendering",
                {{"algorithm", "summation"},
                 {"stiffness_N_per_m", kStiffness},
                 {"mass_kg", kMass},
                 {"damping_ratio", 0},
                 {"friction", {{"mu_s_N_s_per_m", 0}, {"mu_f_s_per_m", 0}}}}}}};
}

std::vector<WorkPrecisionProblem> study(const std::vector<std::string>& over, double max_error = 1e-6,
                                        const std::vector<std::string>& overrides = {}) {
  WorkPrecisionQuestion question{oscillator()};
  question.overrides = overrides;
  for (const std::string& axis : over) question.over.push_back(parse_axis(axis));
  question.max_error = max_error;
  return work_precision(question, {});
}

/// Returns a setting whose run of one simulated second costs `cost` [s], with a reference solution of the error 1.
WorkPrecisionSetting priced(double cost, double error) {
  WorkPrecisionSetting setting{"summation", "rk4"};
  setting.error = {.position = error};
  setting.reference_error = MotionDifference{.position = 1.0};
  setting.cost = {.step_s = 1e-3 * cost, .time_step_s = 1e-3};
  return setting;
}

std::vector<bool> front_of(std::vector<WorkPrecisionSetting> settings) {
  mark_front(settings);
  std::vector<bool> front;
  for (const WorkPrecisionSetting& setting : settings) front.push_back(setting.on_front);
  return front;
}

/// Returns the exact rms error [m] of the position that velocity Verlet computes with the time step h = `step` [s]. The
/// mean is over the times k kStep with k = 0 … kSteps - 1. The solution of velocity Verlet is x_0 cos(omega' t) with
/// cos(omega' h) = 1 - (omega h)^2 / 2.
double exact_error_of_verlet(double step) {
  const double omega = std::sqrt(kStiffness / kMass);
  const double of_verlet = std::acos(1.0 - 0.5 * omega * omega * step * step) / step;
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double t = k * kStep;
    sum += std::pow(kStart * (std::cos(of_verlet * t) - std::cos(omega * t)), 2);
  }
  return std::sqrt(sum / kSteps);
}

TEST(WorkPrecision, FindsTheErrorsOfAnOscillator) {
  const auto problems = study({"integrator.type=velocity_verlet,rk4"});
  ASSERT_EQ(problems.size(), 1u);
  const WorkPrecisionProblem& problem = problems[0];
  EXPECT_TRUE(problem.is_predictable) << problem.grown_shift;
  ASSERT_EQ(problem.settings.size(), 8u);
  for (const WorkPrecisionSetting& setting : problem.settings) {
    ASSERT_TRUE(setting.error) << setting.integrator << " " << setting.step_s;
    // The force is K times the position, and is rounded.
    const double rounding = kStiffness * kStart * std::numeric_limits<double>::epsilon();
    EXPECT_NEAR(setting.error->force, kStiffness * setting.error->position, 1e-9 * setting.error->force + rounding);
    EXPECT_GT(setting.cost.step_s, 0.0);
    EXPECT_EQ(setting.cost.steps, static_cast<std::uint64_t>(std::lround(kSteps * kStep / setting.step_s)));
    if (setting.integrator != "velocity_verlet") continue;
    // The reference is rk4 with a step h / 128. Its error is (omega h / 128)^5 / 120 in a step, below 1e-13 of x_0.
    EXPECT_NEAR(setting.error->position, exact_error_of_verlet(setting.step_s), 1e-9 * kStart) << setting.step_s;
    EXPECT_TRUE(setting.is_resolved());
  }
}

TEST(WorkPrecision, ChoosesTheCheapestSettingBelowAnError) {
  const auto problems = study({"integrator.type=leapfrog,velocity_verlet,rk4"});
  const WorkPrecisionProblem& problem = problems[0];
  const WorkPrecisionSetting* best = problem.cheapest_below(1e-6);
  ASSERT_NE(best, nullptr);
  for (const WorkPrecisionSetting& other : problem.settings) {
    if (other.error && other.error->position < 1e-7) {
      EXPECT_LE(best->cost.per_simulated_second(), other.cost.per_simulated_second());
    }
  }
  EXPECT_EQ(problem.cheapest_below(1e-300), nullptr);
}

/// Checks that an unresolved error, which is at most 3 + 1, beats dearer settings with a larger error.
TEST(WorkPrecision, CountsAnUnresolvedErrorAsItsBound) {
  const WorkPrecisionSetting unresolved = priced(3, 3);
  ASSERT_FALSE(unresolved.is_resolved());
  EXPECT_EQ(front_of({priced(1, 40), priced(2, 20), unresolved, priced(4, 10)}),
            (std::vector<bool>{true, true, false, false}));
  // A failed run beats no setting.
  WorkPrecisionSetting failed = unresolved;
  failed.is_expected = false;
  EXPECT_EQ(front_of({priced(1, 40), priced(2, 20), failed, priced(4, 10)}),
            (std::vector<bool>{true, true, false, true}));
}

TEST(WorkPrecision, SeparatesErrorsThatAreBelowFromErrorsThatMayBe) {
  WorkPrecisionProblem problem{"summation"};
  problem.settings = {priced(1, 40), priced(2, 3), priced(3, 1)};
  // The errors of the last two settings are at most 4 and 2, and may be 0.
  EXPECT_EQ(problem.cheapest_below(3.5), &problem.settings[2]);
  EXPECT_EQ(problem.cheapest_possibly_below(3.5), &problem.settings[1]);
  EXPECT_EQ(problem.cheapest_below(1.5), nullptr);
  EXPECT_EQ(problem.cheapest_possibly_below(1.5), &problem.settings[2]);
}

/// Checks that all settings have the same reference solution. Without contacts, `event` computes the trajectory of rk4.
TEST(WorkPrecision, GivesEqualTrajectoriesEqualErrors) {
  const WorkPrecisionProblem problem = study({"integrator.type=rk4,velocity_verlet,event"})[0];
  ASSERT_EQ(problem.settings.size(), 12u);
  for (std::size_t level = 0; level < 4; ++level) {
    const WorkPrecisionSetting &rk4 = problem.settings[level], &event = problem.settings[8 + level];
    ASSERT_TRUE(rk4.error && event.error);
    EXPECT_EQ(rk4.error->position, event.error->position);
    EXPECT_EQ(rk4.reference_error->position, event.reference_error->position);
  }
  // The reference solution is as exact as its check by velocity_verlet shows.
  EXPECT_GE(problem.settings[0].reference_error->position, 0.9 * exact_error_of_verlet(kStep / 128));
}

TEST(WorkPrecision, TreatsEveryLawAsAProblem) {
  const auto problems = study({"rendering.algorithm=summation,shaped_stiffness"});
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].name, "summation");
  EXPECT_EQ(problems[1].name, "shaped_stiffness");
  for (const WorkPrecisionProblem& problem : problems) EXPECT_EQ(problem.settings.size(), 4u);
}

TEST(WorkPrecision, StatesNoErrorOfATrajectoryThatCannotBePredicted) {
  // Request an error so small that the distance between runs that start kInitialShift apart exceeds it.
  const auto problems = study({"integrator.type=leapfrog"}, 1e-12);
  EXPECT_FALSE(problems[0].is_predictable);
  EXPECT_GT(problems[0].grown_shift, 0.1 * kInitialShift);
  for (const WorkPrecisionSetting& setting : problems[0].settings) EXPECT_FALSE(setting.error);
}

/// Checks that each problem has the delay of its own: with the delay of the axis, the tool moves like in a study of a
/// scene with this delay.
TEST(WorkPrecision, KeepsTheDelayOfEachProblem) {
  const std::string device = R"(device={"type":"impedance","handle_mass_kg":0.1})";
  const auto both = study({"device.delay_samples=0,2"}, 1e-6, {device});
  ASSERT_EQ(both.size(), 2u);
  for (const std::size_t i : {0u, 1u}) {
    const auto alone = study({}, 1e-6, {device, i == 0 ? "device.delay_samples=0" : "device.delay_samples=2"});
    ASSERT_TRUE(both[i].settings[0].error && alone[0].settings[0].error);
    EXPECT_EQ(both[i].settings[0].error->position, alone[0].settings[0].error->position) << i;
  }
  EXPECT_NE(both[0].settings[0].error->position, both[1].settings[0].error->position);
}

/// Checks that a noise that differs between time steps is named, and that no error is stated.
TEST(WorkPrecision, StatesNoErrorIfEachTimeStepHasAnotherNoise) {
  const auto problems =
      study({"integrator.type=leapfrog", R"(device={"type":"admittance","sensor":{"noise_N":0.01}})"});
  EXPECT_FALSE(problems[0].is_predictable);
  EXPECT_NE(problems[0].noise.find("device.sensor.noise_N"), std::string::npos) << problems[0].noise;
  for (const WorkPrecisionSetting& setting : problems[0].settings)
    EXPECT_FALSE(setting.error || setting.reference_error);
}

TEST(WorkPrecision, RefusesAnAxisOfTheTimeStep) {
  EXPECT_TRUE(test::input_error_of([] { study({"time.step_s=1e-3,1e-4"}); }));
  EXPECT_TRUE(test::input_error_of([] { study({R"(time={"step_s":1e-3,"steps":64})"}); }));
}

/// Checks that an axis with the integrator is rejected: the study sets the integrator of each curve itself. This would
/// replace the values of this axis, and all problems of the axis would be equal.
TEST(WorkPrecision, RefusesAnAxisThatContainsTheIntegrator) {
  for (const char* axis : {"integrator=leapfrog,rk4", R"(integrator={"type":"rk4"})"}) {
    const auto error = test::input_error_of([axis] { study({axis}); });
    ASSERT_TRUE(error) << axis;
    EXPECT_NE(std::string(error->what()).find("integrator.type"), std::string::npos) << error->what();
  }
}

}  // namespace
}  // namespace hapbench::work_precision_test
