#include "scenarios/analysis/convergence/levels.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "scenarios/analysis/convergence/observed_order.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::levels_test {
namespace {

struct Study {
  LevelSweep levels;
  std::vector<Result> runs;

  std::vector<LevelResult> levels_of(const std::string& metric) const {
    std::vector<LevelResult> results;
    for (std::size_t i = 0; i < runs.size(); ++i) results.push_back(level_result(levels, i, runs[i], metric));
    return results;
  }
  Convergence of(const std::string& metric) const { return convergence_of(levels, levels_of(metric)); }
};

Study convergence_study(const Json& json, std::size_t count = 5, const std::string& path = kStepPath) {
  const ScenarioText scenario{test::data_directory() / "converge.json", json};
  LevelSweep levels = level_sweep(load_scenario(scenario, {}), path, count, 2.0);
  const Cases cases({scenario}, {}, {levels.axis});
  return {std::move(levels), run_all({&cases, 1}, {})};
}

constexpr double kStep = 1e-3, kStiffness = 1000.0, kMass = 0.1, kStart = 1e-3;
constexpr int kSteps = 40;

/// Returns the scenario of a mass on one bilateral spring.
Json spring(double zeta, const char* integrator) {
  return {{"time", {{"step_s", kStep}, {"steps", kSteps}}},
          {"environment", {{"type", "springs"}, {"groups", {{{"direction", {1, 0, 0}}, {"count", 1}}}}}},
          {"initial", {{"position_m", {kStart, 0, 0}}}},
          {"integrator", {{"type", integrator}}},
          {"rendering",
           {{"algorithm", "summation"},
            {"stiffness_N_per_m", kStiffness},
            {"mass_kg", kMass},
            {"damping_ratio", zeta},
            {"friction", {{"mu_s_N_s_per_m", 0}, {"mu_f_s_per_m", 0}}}}}};
}

TEST(Converge, KnowsTheFormalOrderOfEveryIntegrator) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const double zeta : {0.0, 0.2}) {
      const ScenarioText scenario{"x.json", spring(zeta, integrator->info.name)};
      EXPECT_EQ(level_sweep(load_scenario(scenario, {}), kStepPath, 3, 2.0).formal_order,
                zeta > 0.0                 ? integrator->damped_order
                : integrator == &kLeapfrog ? 2
                                           : integrator->order)
          << integrator->info.name << " " << zeta;
    }
  }
}

/// Checks the order of the amplitudes of leapfrog on an undamped spring, x0 / sqrt(1 - (w h / 2)^2): order 2.
TEST(Converge, FindsSecondOrderInTheAmplitudeOfAnUndampedSpring) {
  Json scene = spring(0.0, "leapfrog");
  scene["time"]["steps"] = 4000;  // 64 periods, so that some steps are close to the peaks
  const Study study = convergence_study(scene);
  const auto levels = study.levels_of("force_max_N");
  const Convergence c = convergence_of(study.levels, levels, {.smooth = false, .either_sign = false});
  ASSERT_TRUE(c.order) << c.reason;
  EXPECT_NEAR(*c.order, 2.0, 0.1);
  EXPECT_NEAR(*c.extrapolated, kStiffness * kStart, *c.errors.back());
}

/// Checks the spread of the largest speed. A level with smaller time steps counts only every n-th step, so that its
/// counted steps are as far apart as the steps of the coarsest level. The spread is the range of the largest speed over
/// all n choices of the first counted step. The largest speed occurs in the last counted step before the landing. Over
/// all choices, it varies by about the speed that is gained between two counted steps.
TEST(Converge, EstimatesTheSpreadOfExtremesOverTheChoiceOfRows) {
  Json scene = {{"time", {{"step_s", 1e-3}, {"steps", 200}}},
                {"environment", {{"type", "springs"}, {"bilateral", false}}},
                {"initial", {{"position_m", {0, 0, 1e-3}}}},
                {"hand", {{"type", "force"}, {"z_N", -0.1}}},
                {"rendering",
                 {{"algorithm", "summation"},
                  {"stiffness_N_per_m", 1000},
                  {"mass_kg", 0.1},
                  {"damping_N_s_per_m", 100},
                  {"friction", {{"mu_s_N_s_per_m", 0}, {"mu_f_s_per_m", 0}}}}}};
  scene["environment"]["groups"] = {{{"direction", {0, 0, -1}}, {"count", 1}}};
  const Study study = convergence_study(scene, 4);
  const auto levels = study.levels_of("speed_max_m_per_s");
  EXPECT_EQ(levels.front().spread, 0.0) << "every row counts";
  // Speed [m/s] that is gained in 1 ms at 1 m/s^2. Counted steps are 1 ms apart, so the last counted step before the
  // landing is at most 1 ms before the landing.
  const double gain = 1e-3;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    EXPECT_GT(levels[i].spread, 0.5 * gain) << i;
    EXPECT_LT(levels[i].spread, 1.5 * gain) << i;
  }
  const Convergence c = convergence_of(study.levels, levels, {.smooth = false, .either_sign = false});
  const double landing_speed = std::sqrt(2.0 * 1.0 * 1e-3);
  EXPECT_NEAR(*levels.back().result, landing_speed, *c.errors.back());
}

/// Checks that all levels are measured at the same times. For a prescribed motion, the change of the force between two
/// measured times therefore does not depend on the time step. If every step were measured, a quarter of the time step
/// would give a quarter of this change.
TEST(Converge, MeasuresAtTheTimesOfTheCoarsestRows) {
  Json scene = spring(0.2, "leapfrog");
  scene["motion"] = {{"position",
                      {{"type", "prescribed"},
                       {"x_m", {{"type", "sine"}, {"mean", 0}, {"amplitude", 1e-3}, {"period_s", 0.013}}},
                       {"y_m", 0},
                       {"z_m", 0}}}};
  scene["rendering"]["damping_ratio"] = 0;
  const Study study = convergence_study(scene);
  for (const char* metric : {"force_max_N", "force_step_max_N", "force_reversals"}) {
    const auto levels = study.levels_of(metric);
    const double first = *levels.front().result;
    // The measured times are products with two rounding errors. They change the position at most by these errors times
    // the largest speed, 2 pi 1e-3 m per period.
    for (const LevelResult& level : levels) EXPECT_NEAR(*level.result, first, 1e-12 * first) << metric;
    EXPECT_NE(study.of(metric).reason.find("rounding"), std::string::npos) << study.of(metric).reason;
  }
  EXPECT_EQ(study.runs[4].end.rows, 16u * kSteps);
}

TEST(Converge, KeepsTheLengthOfDelays) {
  Json scene = spring(0.2, "leapfrog");
  scene["device"] = {{"type", "impedance"}, {"handle_mass_kg", 0.1}, {"delay_samples", 1.5}};
  const LevelSweep levels = level_sweep(load_scenario(ScenarioText{"x.json", scene}, {}), kStepPath, 3, 2.0);
  EXPECT_EQ(levels.axis.values, (std::vector<std::string>{"0.001", "0.0005", "0.00025"}));
  EXPECT_EQ(levels.axis.along[2].stride, 4);
  EXPECT_EQ(levels.axis.along[2].overrides, (std::vector<std::string>{"time.steps=160", "device.delay_samples=6"}));
  EXPECT_EQ(levels.formal_order, 1.0);
  scene.erase("device");
  scene["rendering"]["contacts"] = {{"every", 8}, {"delay_samples", 4}};
  const LevelSweep late = level_sweep(load_scenario(ScenarioText{"x.json", scene}, {}), kStepPath, 3, 2.0);
  EXPECT_EQ(late.axis.along[2].overrides, (std::vector<std::string>{"time.steps=160", "rendering.contacts.every=32",
                                                                    "rendering.contacts.delay_samples=16"}));
}

/// Checks that only noise that is drawn in every step prevents an order, whatever draws it, and that it is named.
TEST(Converge, HasNoOrderWithANoiseThatEveryStepDraws) {
  Json impedance = {{"type", "impedance"}, {"handle_mass_kg", 0.1}}, admittance = {{"type", "admittance"}};
  const auto reason = [](const char* section, const Json& fields) {
    Json scene = spring(0.2, "leapfrog");
    scene[section] = fields;
    return level_sweep(load_scenario(ScenarioText{"x.json", scene}, {}), kStepPath, 3, 2.0).no_order;
  };
  EXPECT_EQ(reason("device", impedance), "");
  impedance["position_noise_m"] = 1e-6;
  EXPECT_NE(reason("device", impedance).find("device.position_noise_m"), std::string::npos);
  admittance["sensor"] = {{"noise_N", 0.0}};
  EXPECT_EQ(reason("device", admittance), "");
  admittance["sensor"] = {{"noise_N", 0.01}};
  EXPECT_NE(reason("device", admittance).find("device.sensor.noise_N"), std::string::npos);
  const auto subject = [](const char* scene, double motor, double tilt) {
    const std::string quiet = R"({"motor_noise_N":0,"tilt_noise_rad":0})",
                      second = fmt::format(R"({{"motor_noise_N":{},"tilt_noise_rad":{}}})", motor, tilt);
    const std::vector<std::string> fields = {R"(device={"type":"ideal"})",
                                             fmt::format("hand.subjects=[{},{}]", quiet, second)};
    const ScenarioText peg = read_scenario_text(find_scenario(scene));
    return level_sweep(load_scenario(peg, fields), kStepPath, 3, 2.0).no_order;
  };
  const char *upright = "vertical_peg_in_hole_shaped_stiffness", *turning = "rotational_peg_in_hole_shaped_stiffness";
  EXPECT_EQ(subject(upright, 0.0, 0.0), "");
  EXPECT_NE(subject(upright, 0.01, 0.0).find("hand.subjects"), std::string::npos);
  EXPECT_EQ(subject(upright, 0.0, 0.01), "") << "a subject tilts the tool only if the task displays heights";
  EXPECT_NE(subject(turning, 0.0, 0.01).find("hand.subjects"), std::string::npos);
}

}  // namespace
}  // namespace hapbench::levels_test
