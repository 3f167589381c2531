#include "scenarios/limits/stability/field_limit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/load_scenario.hpp"

/// Limits of springs by theory and by runs, of fields beside K, and under bounds on metrics are in tests/known_answers
/// and tests/equivalence.
namespace hapbench::field_limit_test {
namespace {

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
  question.smallest = asked.smallest;
  static_cast<StabilityRule&>(question) = asked.rule;
  return field_limit(question);
}

using Stable = std::function<bool(double value)>;

/// What find_tried_edge gives from 1e4 to 1e6: the last stable value, 0 without an edge, -1 for scattered ones.
double tried_edge(const Stable& stable) {
  const SearchWay way{.range = {1e4, 1e6, true}};
  const auto holds = [&](double part) { return stable(way.value_at(part)); };
  std::map<double, bool> tried = scanned(kEdgeIntervals, holds);
  const FoundEdge edge = find_tried_edge(way, tried, holds, true, [](std::span<const double>) {});
  return edge.stable ? way.value_at(*edge.stable) : edge.scattered ? -1.0 : 0.0;
}

TEST(TriedEdge, IsBelowAnIslandThatBisectionDoesNotMeet) {
  const Stable islands = [](double K) { return K < 3e5 && !(K > 1.05e5 && K < 1.2e5); };
  const SearchWay way{.range = {1e4, 1e6, true}};
  const auto holds = [&](double part) { return islands(way.value_at(part)); };
  std::map<double, bool> tried = scanned(kEdgeIntervals, holds);
  EXPECT_NEAR(way.value_at(find_edge(way, tried, holds, true).stable.value()), 3e5, 300.0);
  EXPECT_NEAR(tried_edge(islands), 1.05e5, 105.0);
}

TEST(TriedEdge, IsOfAStretchOfTwoPercent) {
  // 56 234 and 237 137 are values of the scan.
  EXPECT_EQ(tried_edge([](double K) { return K > 56000.0 && K < 56500.0; }), -1.0);
  EXPECT_NEAR(tried_edge([](double K) { return (K > 56000.0 && K < 56500.0) || (K > 2e5 && K < 3e5); }), 3e5, 300.0);
  EXPECT_EQ(tried_edge([](double K) { return std::fmod(std::sqrt(K) + 0.5, 1.0) < 0.5; }), -1.0) << "by chance";
  EXPECT_EQ(tried_edge([](double) { return false; }), 0.0);
}

TEST(TriedEdge, LeavesAShareThatMayFail) {
  EXPECT_NEAR(std::pow(1.0 - may_fail_share(48), 48.0), 0.05, 1e-12);
  EXPECT_NEAR(may_fail_share(48), 0.0605, 1e-4);
}

/// A flat tip without damping and friction under 1 N bounces for ever: a run that seems to die out does so by chance.
TEST(FieldLimit, OfWhatNeverRestsIsNone) {
  const FieldLimit limit = ask({"poke_plane",
                                "rendering.stiffness_N_per_m",
                                {R"(hand={"type":"force","z_N":-1})", "time.duration_s=0.5", "rendering.reduction=null",
                                 "rendering.damping_ratio=0", R"(rendering.friction={"mu_s_N_s_per_m":0})"}},
                               "mean");
  EXPECT_FALSE(limit.value) << *limit.value;
}

/// 2000 steps, within which a decay of a tenth in a quarter tells stable from vibrating 0.1 % below the limit.
const Words kLong = {"time.steps=2000"};

/// The handle, 0.1 kg without friction, on an undamped spring behind a delay is unstable at every K, if slowly at small
/// ones: K = 1 N/m grows by 0.1 % a second.
const Words kSlow = {"time={\"step_s\":0.001,\"steps\":1000}",
                     R"(device={"type":"impedance","handle_mass_kg":0.1,"viscous_N_s_per_m":0,"delay_samples":1})",
                     "rendering.damping_N_s_per_m=0"};

TEST(FieldLimit, IsNoneWhereGrowthIsSlow) {
  const FieldLimit limit = ask({"single_spring", "rendering.stiffness_N_per_m", kSlow, Range{10.0, 1000.0, false}});
  EXPECT_FALSE(limit.value) << "35 N/m make half a turn in 100 ms, a quarter of the run";
  EXPECT_TRUE(limit.theory_has_none);
  EXPECT_FALSE(limit.theory);
}

/// A heavy handle that taps a wall bounces below 30 Hz: its force stays, but one that rests is stable up to the edge of
/// the linear loop alone, 1774 N/m.
TEST(FieldLimit, OfADeviceAtAWallIsComparedWithItsLinearLoop) {
  const Words device = {R"(device={"type":"impedance","handle_mass_kg":3,"viscous_N_s_per_m":0.2,"delay_samples":3})"};
  const FieldLimit limit = ask({.scenario = "tap_wall",
                                .field = "rendering.stiffness_N_per_m",
                                .overrides = device,
                                .rule = {.most_vibration = 1e-3}});
  ASSERT_TRUE(limit.value && limit.linear);
  EXPECT_NEAR(*limit.linear, 1773.8, 0.1);
  EXPECT_TRUE(limit.is_beyond_linear(0.01));
}

TEST(FieldLimit, OfAFieldOfIntegersIsOne) {
  // n (2 B dt / M + K dt^2 / M) = 4 with B = 62.6 N s/m, K = 20 000 N/m: n = 5.9.
  const FieldLimit limit = ask({"single_spring", "environment.groups.0.count", kLong, Range{1.0, 100.0, false}});
  EXPECT_EQ(*limit.value, 5.0);
  EXPECT_EQ(limit.beyond->value, 6.0);
  EXPECT_EQ(*limit.theory, 5.0);
}

/// A passive hand on a handle with dry friction is stable, although it sticks and slips.
TEST(FieldLimit, DoesNotBlameDryFrictionForVibration) {
  const Words rubbing = {R"(device={"type":"impedance","handle_mass_kg":0.136,"coulomb_N":0.25,"delay_samples":1})",
                         "time.step_s=0.00035"};
  const FieldLimit limit = ask({"tap_wall", "rendering.stiffness_N_per_m", rubbing, Range{1e3, 1e6, true}});
  ASSERT_TRUE(limit.value && limit.beyond);
  EXPECT_EQ(limit.beyond->verdict, RunVerdict::vibrating);
  EXPECT_FALSE(limit.unstable_alone);
}

/// What is asked about hand and device alone has no points, and yet a stage that merges the points of a cell.
TEST(FieldLimit, OfASceneWithLocalAverageIsOne) {
  const Asked asked{"tap_corner", "rendering.stiffness_N_per_m", {"time.steps=200"}, Range{1e6, 1e8, true}};
  Asked averaged = asked;
  averaged.overrides.emplace_back("rendering.local_average=true");
  EXPECT_EQ(ask(averaged).unstable_alone, ask(asked).unstable_alone);
}

}  // namespace
}  // namespace hapbench::field_limit_test
