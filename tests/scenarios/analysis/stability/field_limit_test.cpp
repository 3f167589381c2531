#include "scenarios/analysis/stability/field_limit.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/load_scenario.hpp"

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

TEST(FieldLimit, OfAFieldOfIntegersIsOne) {
  // The limit is n (2 B dt / M + K dt^2 / M) = 4 for n springs with B = 62.6 N s/m, K = 20 000 N/m: n = 5.9.
  const FieldLimit limit = ask({"single_spring", "environment.groups.0.count", kLong, Range{1.0, 100.0, false}});
  EXPECT_EQ(*limit.end.value, 5.0);
  EXPECT_EQ(limit.end.beyond->value, 6.0);
  EXPECT_EQ(*limit.theory, 5.0);
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
