#include "scenarios/analysis/stability/field_limit.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/results/files.hpp"

namespace hapbench::field_limit_test {
namespace {

// Tests stability limits of fields in special cases. tests/known_answers tests the limits of springs by theory and by
// runs, the limits of fields other than K, and limits with bounds on metrics.

using Words = std::vector<std::string>;

struct Asked {
  const char* scenario;
  const char* field;
  Words overrides = {};
  std::optional<Range> range = {};
  bool smallest = false;
  StabilityRule rule = {};
};

FieldLimit ask(const Asked& asked, const char* algorithm = "summation") {
  const ScenarioText scenario = read_scenario_text(find_scenario(asked.scenario));
  Words overrides = asked.overrides;
  overrides.push_back(std::string("rendering.algorithm=") + algorithm);
  LimitQuestion question = limit_question(scenario, overrides, asked.field, asked.range);
  question.search.smallest = asked.smallest;
  question.rule = asked.rule;
  return field_limit(question);
}

/// Checks a flat tip without damping and friction, which bounces forever under 1 N. If a single run is classified as
/// decaying, this is by chance.
TEST(FieldLimit, OfWhatNeverRestsIsNone) {
  const FieldLimit limit = ask({"poke_plane",
                                "rendering.stiffness_N_per_m",
                                {R"(hand={"type":"force","z_N":-1})", "time.duration_s=0.5", "rendering.reduction=null",
                                 "rendering.damping_ratio=0", R"(rendering.friction={"mu_s_N_s_per_m":0})"}},
                               "mean");
  EXPECT_FALSE(limit.end.value) << *limit.end.value;
}

/// Override with a number of steps that is large enough: a run at 0.1 % below the limit counts as stable, because its
/// amplitude decreases by at least a tenth within a quarter of the run.
const Words kLong = {"time.steps=2000"};

/// Scene that is unstable at every K: a handle of 0.1 kg without friction, on an undamped spring with a delay. At small
/// K the amplitude grows slowly, at K = 1 N/m by 0.1 % per second.
const Words kSlow = {"time={\"step_s\":0.001,\"steps\":1000}",
                     R"(device={"type":"impedance","handle_mass_kg":0.1,"viscous_N_s_per_m":0,"delay_samples":1})",
                     "rendering.damping_N_s_per_m=0"};

TEST(FieldLimit, IsNoneWhereGrowthIsSlow) {
  const FieldLimit limit = ask({"single_spring", "rendering.stiffness_N_per_m", kSlow, Range{10.0, 1000.0, false}});
  EXPECT_FALSE(limit.end.value) << "35 N/m make half a turn in 100 ms, a quarter of the run";
  EXPECT_TRUE(limit.theory_has_none);
  EXPECT_FALSE(limit.theory);
}

/// Checks a heavy handle that taps a wall. It bounces below 30 Hz in every stable run, so no contact lasts.
TEST(FieldLimit, HasNoLinearLimitIfContactsComeAndGo) {
  const Words device = {R"(device={"type":"impedance","handle_mass_kg":3,"viscous_N_s_per_m":0.2,"delay_samples":3})"};
  const FieldLimit limit = ask({.scenario = "tap_wall",
                                .field = "rendering.stiffness_N_per_m",
                                .overrides = device,
                                .rule = {.max_vibration = 1e-3}});
  ASSERT_TRUE(limit.end.value);
  EXPECT_FALSE(limit.linear);
  EXPECT_EQ(limit.no_linear, "contacts come and go in every stable run");
  EXPECT_EQ(limit.quoted.value, limit.end.value);
}

/// A tilted peg in a planar hole. Along z, the contact pushes the peg away from the plane, but the peg never leaves
/// this plane: the linear limit is that of the two directions within the plane, which the runs confirm within the
/// resolution of the search.
TEST(FieldLimit, OfAPlanarSceneLeavesOutTheDirectionAcrossThePlane) {
  const char* const motion = R"(motion={"orientation":{"tilt_rad":
    {"type":"waypoints","interpolation":"cosine","points":[[0,0],[0.4,-0.18]]}}})";
  const char* const hand = R"(hand={"type":"impedance","stiffness_N_per_m":300,"damping_N_s_per_m":6,
    "target":{"x_m":0,"y_m":-0.0045,"z_m":0}})";
  const Words scene = {motion,
                       hand,
                       R"(environment={"type":"hole_2d","width_m":0.001,"depth_m":0.005,"spacing_m":0.0001})",
                       R"(tool={"diameter_m":0.001,"length_m":0.01,"tip":"round"})",
                       R"(initial={"position_m":[0,-0.003,0]})",
                       R"(time={"step_s":0.0005,"duration_s":1})",
                       R"(rendering={"depth_model":"shortest_distance","stiffness_N_per_m":20000,"damping_ratio":0.7})",
                       R"(device={"type":"ideal"})"};
  const FieldLimit limit = ask({.scenario = "poke_plane",
                                .field = "rendering.stiffness_N_per_m",
                                .overrides = scene,
                                .rule = {.max_vibration = 1e-3}},
                               "shaped_stiffness");
  ASSERT_TRUE(limit.linear && limit.end.value);
  EXPECT_NEAR(*limit.linear, *limit.end.value, 0.01 * *limit.linear);
}

/// Checks a flat tip with the law `proxy`, which renders one of 49 equal points. Rounding decides which point. The
/// contact lasts, although the number of the rendered point changes. At K = 1700 N/m, the tool begins at its
/// equilibrium.
TEST(FieldLimit, HasALinearLimitIfAnotherEqualPointIsRendered) {
  const char* const hand =
      R"(hand={"type":"mass_spring_damper","mass_kg":0.1,"stiffness_N_per_m":200,"damping_N_s_per_m":3,
               "target":{"x_m":0,"y_m":0,"z_m":-0.005}})";
  const char* const device =
      R"(device={"type":"impedance","handle_mass_kg":0.15,"viscous_N_s_per_m":0.2,"delay_samples":1})";
  const char* const rendering =
      R"(rendering={"stiffness_N_per_m":1700,"damping_N_s_per_m":2,
                    "friction":{"mu_s_N_s_per_m":0,"mu_f_s_per_m":0}})";
  const Words scene = {hand,
                       device,
                       rendering,
                       "time={\"step_s\":0.001,\"duration_s\":3}",
                       "environment.size_m=0.02",
                       "environment.spacing_m=0.0005",
                       "tool.diameter_m=0.004"};
  const auto linear_from = [&](const char* position) {
    Words overrides = scene;
    overrides.emplace_back(std::string("initial.position_m=") + position);
    const FieldLimit limit = ask({"poke_plane", "rendering.stiffness_N_per_m", overrides}, "proxy");
    EXPECT_TRUE(limit.linear) << position << ": " << limit.no_linear;
    return limit.linear.value_or(0.0);
  };
  const double above = linear_from("[0,0,0.0001]"), at_rest = linear_from("[0,0,-0.000526316]");
  EXPECT_NEAR(at_rest, above, 1e-6 * above);  // larger than the error of the derivatives, 1e-7
}

/// A flat tip that a passive hand holds 5 mm below a surface. At rest, its depth is 1 N / (K + 200 N/m).
const char* const kHeldBelow = R"({
  "time": {"step_s": 0.001, "duration_s": 3},
  "environment": {"type": "plane", "size_m": 0.02, "spacing_m": 0.0005}, "initial": {"position_m": [0, 0, 0.0001]},
  "tool": {"diameter_m": 0.004, "length_m": 0.03, "tip": "flat"},
  "hand": {"type": "mass_spring_damper", "mass_kg": 0.1, "stiffness_N_per_m": 200, "damping_N_s_per_m": 3,
           "target": {"x_m": 0, "y_m": 0, "z_m": -0.005}},
  "device": {"type": "impedance", "handle_mass_kg": 0.15, "viscous_N_s_per_m": 0.2, "delay_samples": 1},
  "rendering": {"stiffness_N_per_m": 1500, "damping_N_s_per_m": 2,
                "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}
})";

class FieldLimitOfHeldTip : public ::testing::Test {
 protected:
  FieldLimitOfHeldTip() { test::write_plainly(folder_ / "held.json", kHeldBelow); }
  test::TemporaryDirectory folder_;
  const std::string scene_ = folder_ / "held.json";
};

/// Checks a bound with a minimum and a maximum. A depth of 0.4 to 0.5 mm holds for K from 1800 to 2300 N/m, a factor of
/// 1.28. The values of the scan are a factor of 1.9 apart, and none of them is in this interval.
TEST_F(FieldLimitOfHeldTip, FindsANarrowIntervalBetweenDifferentFailures) {
  const FieldLimit bounded = ask({.scenario = scene_.c_str(),
                                  .field = "rendering.stiffness_N_per_m",
                                  .range = Range{1.0, 30000.0, true},
                                  .rule = {.bounds = {{"inside_settled_m", {.min = 4e-4, .max = 5e-4}}}}},
                                 "proxy");
  ASSERT_TRUE(bounded.end.value && bounded.other.value);
  // The resolution of the search is 0.1 %; the depth has a tolerance of 2 %.
  EXPECT_NEAR(*bounded.other.value, 1800.0, 0.03 * 1800.0);
  EXPECT_NEAR(*bounded.end.value, 2300.0, 0.03 * 2300.0);
}

/// Checks the smallest stable viscous friction of a handle against the eigenvalues of the loop. With dry friction, the
/// runs also rest where the loop is unstable; the limit to quote is the linear one.
TEST_F(FieldLimitOfHeldTip, OfTheSmallestValueIsTheLinearLimitIfDryFrictionHoldsTheRuns) {
  const auto smallest = [&](const char* coulomb) {
    return ask({.scenario = scene_.c_str(),
                .field = "device.viscous_N_s_per_m",
                .overrides = {"rendering.stiffness_N_per_m=6000", std::string("device.coulomb_N=") + coulomb},
                .range = Range{1.0, 20.0, true},
                .smallest = true},
               "proxy");
  };
  const FieldLimit smooth = smallest("0"), rough = smallest("0.2");
  ASSERT_TRUE(smooth.linear && rough.linear) << smooth.no_linear << rough.no_linear;
  // A run counts as stable if it decays by a tenth in 0.75 s. With a moving mass of 0.25 kg on a continuous spring,
  // this takes 2 * 0.25 kg * 0.1054 / 0.75 s = 0.0703 N s/m of friction above the linear limit; the sampling of the
  // spring (a phase of 0.15 rad per step) changes this by a few per cent. The resolution of the search is 0.1 %.
  EXPECT_GE(*smooth.end.value, *smooth.linear);
  EXPECT_LE(*smooth.end.value, 1.001 * (*smooth.linear + 1.05 * 0.0703));
  EXPECT_TRUE(smooth.beyond_fades);
  EXPECT_NEAR(*rough.linear, *smooth.linear, 1e-6 * *smooth.linear);
  EXPECT_LT(*rough.end.value, *rough.linear);
  EXPECT_EQ(rough.quoted.value, rough.linear);
}

TEST(FieldLimit, OfAFieldOfIntegersIsOne) {
  // The limit is n (2 B dt / M + K dt^2 / M) = 4 for n springs with B = 62.6 N s/m, K = 20 000 N/m: n = 5.9.
  const FieldLimit limit = ask({"single_spring", "environment.groups.0.count", kLong, Range{1.0, 100.0, false}});
  EXPECT_EQ(*limit.end.value, 5.0);
  EXPECT_EQ(limit.end.beyond->value, 6.0);
  EXPECT_EQ(*limit.theory, 5.0);
  EXPECT_TRUE(limit.tried_all);
}

/// Checks a field of integers that the scenario does not give. Its type follows from the values that it allows.
TEST(FieldLimit, OfAFieldOfIntegersThatTheSceneDoesNotGive) {
  const FieldLimit limit = ask({"tap_wall", "rendering.contacts.every", {}, Range{1.0, 40.0, true}});
  for (const JudgedValue& run : limit.runs) EXPECT_EQ(run.value, std::round(run.value));
  EXPECT_FALSE(limit.runs.empty());
}

/// Checks that a passive hand on a handle with dry friction is stable, although the handle sticks and slips.
TEST(FieldLimit, DoesNotBlameDryFrictionForVibration) {
  const Words rubbing = {R"(device={"type":"impedance","handle_mass_kg":0.136,"coulomb_N":0.25,"delay_samples":1})",
                         "time.step_s=0.00035"};
  const FieldLimit limit = ask({"tap_wall", "rendering.stiffness_N_per_m", rubbing, Range{1e3, 1e6, true}});
  ASSERT_TRUE(limit.end.value && limit.end.beyond);
  EXPECT_EQ(limit.end.beyond->verdict, RunVerdict::vibrating);
  EXPECT_FALSE(limit.unstable_alone);
}

/// Checks a wall that holds the handle from both sides. The linear model of the loop contains neither dry friction nor
/// the encoder, so they do not change the linear limit. The handle may come to rest at a position where no spring is
/// deflected.
TEST(FieldLimit, OfAHandleWithFrictionHasTheLinearLimitWithoutFriction) {
  const std::string smooth = R"("type":"impedance","handle_mass_kg":0.35,"viscous_N_s_per_m":0.5,"delay_samples":1)";
  const auto limit_of = [](const std::string& device) {
    return ask({.scenario = "wall_on_handle",
                .field = "rendering.stiffness_N_per_m",
                .overrides = {"device={" + device + "}", "time.steps=2000"},
                .range = Range{100.0, 1e6, true},
                .rule = {.bounded = true}});
  };
  const FieldLimit without = limit_of(smooth);
  ASSERT_TRUE(without.theory);
  for (const char* rough :
       {R"(,"coulomb_N":0.3)", R"(,"encoder_step_m":4e-5)", R"(,"coulomb_N":0.3,"force_step_N":0.01)"}) {
    const FieldLimit with = limit_of(smooth + rough);
    EXPECT_FALSE(with.theory) << rough;
    ASSERT_TRUE(with.linear) << rough << ": " << with.no_linear;
    EXPECT_EQ(*with.linear, *without.theory) << rough;
  }
}

/// Checks a scene with `local_average`, the stage that merges the contacts within a grid cell. The search for the limit
/// also simulates the scene without any points. This stage must then accept an environment without points.
TEST(FieldLimit, OfASceneWithLocalAverageIsOne) {
  const Asked asked{"tap_corner", "rendering.stiffness_N_per_m", {"time.steps=200"}, Range{1e6, 1e8, true}};
  Asked averaged = asked;
  averaged.overrides.emplace_back("rendering.local_average=true");
  EXPECT_EQ(ask(averaged).unstable_alone, ask(asked).unstable_alone);
}

}  // namespace
}  // namespace hapbench::field_limit_test
