#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/studies/explanation/rules.hpp"
#include "tests/results/files.hpp"

namespace hapbench::explain_test {
namespace {

using Words = std::vector<std::string>;

struct Explained {
  const char* scene;
  Words overrides = {};
};

std::set<std::string> found(const Explained& run, Words* says = nullptr) {
  const test::TemporaryDirectory directory;
  Words overrides = run.overrides;
  overrides.emplace_back("expect={}");
  run_scenario(load_scenario(find_scenario(run.scene), overrides), directory.path(), false);
  std::set<std::string> rules;
  for (const Explanation& explanation : explained(read_run(directory.path()))) {
    rules.insert(explanation.rule->name);
    if (says != nullptr) says->push_back(explanation.says);
  }
  return rules;
}

/// A scene with the fault, and one that is as like it as can be without.
struct Pair {
  const char* rule;
  Explained with, without;
};

const std::string kTouch = R"(device={"type":"impedance","preset":"omega.3"})";

std::vector<Pair> pairs() {
  const Explained molar = {"drag_molar"};
  return {
      {"diverged", {"single_spring_unstable"}, {"single_spring"}},
      {"sank", {"mesh_molar", {"rendering.stiffness_N_per_m=500"}}, {"mesh_molar"}},
      {"lost", {"mesh_molar", {"initial.position_m=[0,0,0.1]", "hand.z_N=1.5"}}, {"mesh_molar"}},
      {"stuck", {"drag_molar_dry", {"rendering.friction.mu=5"}}, {"drag_molar_dry"}},
      {"edge", {"drag_molar", {"rendering.stiffness_N_per_m=2e6"}}, molar},
      {"buzz", {"drag_molar", {kTouch}}, molar},
      {"pop", {"drag_molar", {kTouch}}, molar},
      {"reduction",
       {"mesh_molar", {R"(rendering.reduction={"threshold":0.9})"}},
       {"mesh_molar", {R"(rendering.reduction=null)"}}},
      {"facets", {"bur_fissure", {"environment.spacing_m=0.0006"}}, {"bur_fissure"}},
      {"deep", {"impedance_at_wall", {"rendering.stiffness_N_per_m=3600"}}, {"impedance_at_wall"}},
      {"soft", {"corner_shaped_stiffness", {"rendering.algorithm=mean"}}, {"corner_shaped_stiffness"}},
      {"hard", {"drag_molar", {"rendering.algorithm=summation"}}, molar},
      {"damping", {"drag_molar", {"rendering.damping_ratio=8"}}, molar},
      {"friction", {"drag_molar", {"rendering.friction.mu_f_s_per_m=1000"}}, molar},
      {"encoder", {"drag_molar", {kTouch}}, {"drag_molar", {kTouch, "device.encoder_step_m=0"}}},
      {"saturated",
       {"impedance_at_wall", {"device.force_max_N=0.5"}},
       {"impedance_at_wall", {"device.force_max_N=10"}}},
      {"limiter", {"device_at_wall", {"device.force_limit_N=0.3"}}, {"device_at_wall"}},
      {"bounces", {"peg_in_hole_2d_original_averaging_passive"}, {"peg_in_hole_2d_shaped_stiffness"}},
      {"chatter", {"peg_in_hole_2d_continuous_normal_projection"}, {"turned_into_wall"}},
      {"energy", {"peg_in_hole_2d_original_averaging"}, {"peg_in_hole_2d_mean"}},
      {"drift",
       {"incline_dry", {"hand.x_N=0.4", R"(rendering.friction={"mu_s_N_s_per_m":5,"mu_f_s_per_m":10})"}},
       {"incline_dry", {"hand.x_N=0.4"}}},
  };
}

TEST(Explain, EachRuleFindsItsFaultAndIsSilentWithout) {
  std::set<std::string> tested;
  for (const Pair& pair : pairs()) {
    EXPECT_TRUE(found(pair.with).contains(pair.rule)) << pair.rule << " in " << pair.with.scene;
    EXPECT_FALSE(found(pair.without).contains(pair.rule)) << pair.rule << " in " << pair.without.scene;
    tested.insert(pair.rule);
  }
  for (const ExplainRule& rule : explain_rules())
    EXPECT_TRUE(tested.contains(rule.name) || std::string_view(rule.name) == "late") << rule.name;
}

/// A step in a nanosecond is late on any machine, and one in a minute on none.
TEST(Explain, FindsStepsThatAreLate) {
  const auto late = [](double step) {
    RunFiles run;
    run.loaded.scenario.time.step = step;
    run.step_time = 1e-5;
    const auto all = explained(run);
    return std::ranges::any_of(all, [](const Explanation& e) { return std::string_view(e.rule->name) == "late"; });
  };
  EXPECT_TRUE(late(9e-6));
  EXPECT_FALSE(late(1.1e-5));
}

TEST(Explain, IsSilentWhereNothingIsWrong) {
  for (const char* scene :
       {"drag_molar", "mesh_molar", "bur_fissure", "device_at_wall", "device_in_hole", "impedance_at_wall", "tap_wall",
        "drag_molar_dry", "plane_pressed_round", "cone_in_undercut", "recorded_wipe", "incline_dry", "single_spring",
        "random_springs", "wedge_stiffness"})
    EXPECT_EQ(found({scene}), std::set<std::string>{}) << scene;
}

/// An undamped spring of 20 000 N/m and 0.1 kg swings at 71.2 Hz; half a turn more or less in the last quarter, of half
/// a second, is 1 Hz.
TEST(Explain, TellsTheFrequencyOfABuzz) {
  Words says;
  const Words undamped = {"rendering.damping_ratio=0.0005", "time.steps=4000"};
  EXPECT_TRUE(found({"single_spring", undamped}, &says).contains("buzz"));
  double frequency = 0.0;
  for (const std::string& text : says) {
    if (const auto at = text.find("at about "); at != std::string::npos) frequency = std::stod(text.substr(at + 9));
  }
  EXPECT_NEAR(frequency, 71.2, 1.5);
}

}  // namespace
}  // namespace hapbench::explain_test
