#include "scenarios/run/diagnosis.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "algorithms/registry.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"

/// What is said of a run that has a fault, and that it is not said of one that is as like it as can be without.
namespace hapbench::diagnosis_test {
namespace {

using Words = std::vector<std::string>;

struct Scene {
  const char* name;
  Words overrides = {};
};

Result run(const Scene& scene) {
  Words overrides = scene.overrides;
  overrides.insert(overrides.end(), {"expect={}", "record.trajectory=false"});
  return run_scenario(load_scenario(find_scenario(scene.name), overrides), std::nullopt, false, nullptr, true);
}

/// What the rule finds; null where it is silent.
const Diagnosed* finding(const Result& run, std::string_view rule) {
  const auto found = std::ranges::find(*run.diagnosis, rule, &Diagnosed::rule);
  return found == run.diagnosis->end() ? nullptr : &*found;
}

struct Pair {
  const char* rule;
  Scene with, without;
};

const std::string kOmega = R"(device={"type":"impedance","preset":"omega.3"})";

std::vector<Pair> pairs() {
  const Scene molar = {"drag_molar"};
  return {
      {"diverged", {"single_spring_unstable"}, {"single_spring"}},
      {"sank", {"mesh_molar", {"rendering.stiffness_N_per_m=500"}}, {"mesh_molar"}},
      {"lost", {"mesh_molar", {"initial.position_m=[0,0,0.1]", "hand.z_N=1.5"}}, {"mesh_molar"}},
      {"stuck", {"drag_molar_dry", {"rendering.friction.mu=5"}}, {"drag_molar_dry"}},
      {"step", {"mesh_molar", {"time.step_s=1", "time.steps=5"}}, {"mesh_molar", {"time.steps=5"}}},
      {"edge", {"drag_molar", {"rendering.stiffness_N_per_m=2e6"}}, molar},
      {"buzz", {"drag_molar", {kOmega}}, molar},
      {"pop", {"drag_molar", {kOmega}}, molar},
      {"reduction",
       {"mesh_molar", {R"(rendering.reduction={"threshold":0.9})"}},
       {"mesh_molar", {R"(rendering.reduction=null)"}}},
      {"facets", {"bur_fissure", {"environment.spacing_m=0.0006"}}, {"bur_fissure"}},
      {"deep", {"impedance_at_wall", {"rendering.stiffness_N_per_m=3600"}}, {"impedance_at_wall"}},
      {"soft", {"corner_shaped_stiffness", {"rendering.algorithm=mean"}}, {"corner_shaped_stiffness"}},
      {"hard", {"drag_molar", {"rendering.algorithm=summation"}}, molar},
      {"damping",
       {"drag_molar", {"rendering.damping_ratio=8"}},
       {"drag_molar", {"rendering.damping_ratio=8", "integrator.type=implicit_euler"}}},
      {"friction", {"drag_molar", {"rendering.friction.mu_f_s_per_m=1000"}}, molar},
      {"encoder", {"drag_molar", {kOmega}}, {"drag_molar", {kOmega, "device.encoder_step_m=0"}}},
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

TEST(Diagnosis, EachRuleFindsItsFaultAndIsSilentWithout) {
  std::set<std::string> tested;
  for (const Pair& pair : pairs()) {
    const Diagnosed* found = finding(run(pair.with), pair.rule);
    EXPECT_NE(found, nullptr) << pair.rule << " in " << pair.with.name;
    EXPECT_EQ(finding(run(pair.without), pair.rule), nullptr) << pair.rule << " in " << pair.without.name;
    tested.insert(pair.rule);
  }
  for (const DiagnosisRule& rule : diagnosis_rules()) EXPECT_TRUE(tested.contains(rule.name)) << rule.name;
}

TEST(Diagnosis, IsSilentWhereNothingIsWrong) {
  for (const char* scene :
       {"drag_molar", "mesh_molar", "bur_fissure", "device_at_wall", "device_in_hole", "impedance_at_wall", "tap_wall",
        "drag_molar_dry", "plane_pressed_round", "cone_in_undercut", "recorded_wipe", "incline_dry", "single_spring",
        "random_springs", "wedge_stiffness"}) {
    const Result result = run({scene});
    for (const Diagnosed& found : *result.diagnosis) ADD_FAILURE() << scene << ": " << found.says;
  }
}

/// An undamped spring of 20 000 N/m and 0.1 kg swings at 71.2 Hz; half a turn more or less in the last quarter, of half
/// a second, is 1 Hz.
TEST(Diagnosis, TellsTheFrequencyOfABuzz) {
  const Result result = run({"single_spring", {"rendering.damping_ratio=0.0005", "time.steps=4000"}});
  const Diagnosed* buzz = finding(result, "buzz");
  ASSERT_NE(buzz, nullptr);
  std::smatch frequency;
  ASSERT_TRUE(std::regex_search(buzz->says, frequency, std::regex(", at about ([0-9]+) Hz"))) << buzz->says;
  EXPECT_NEAR(std::stod(frequency[1]), 71.2, 1.5);
}

/// A law is no remedy for itself.
TEST(Diagnosis, AdvisesNoLawThatIsInUse) {
  const LoadedScenario loaded = load_scenario(find_scenario("drag_molar"), {});
  const auto tool = make_tool(loaded.scenario, loaded.files);
  for (const std::string& law : algorithm_names()) {
    Result result;
    result.algorithm = law;
    result.metrics = {
        {"ratio_min", "1", "", 0.1}, {"ratio_max", "1", "", 10.0}, {"force_reversals_per_s", "1/s", "", 100.0}};
    const auto findings = DiagnosisObserver(loaded.scenario).findings(loaded, result, *tool);
    EXPECT_EQ(findings.size(), 4u) << law;  // soft, hard, damping, chatter
    for (const Diagnosed& found : findings)
      EXPECT_FALSE(std::regex_search(found.attempt, std::regex("\\b" + law + "\\b"))) << law << ": " << found.attempt;
  }
}

/// A step in which the tool flies past the tooth is not the fault of where it started.
TEST(Diagnosis, BlamesTheStepWhereThatIsTooLong) {
  const Result leaps = run({"mesh_molar", {"time.step_s=1", "time.steps=5"}});
  ASSERT_NE(finding(leaps, "lost"), nullptr);
  EXPECT_NE(finding(leaps, "lost")->attempt.find("a shorter time.step_s"), std::string::npos);
  ASSERT_FALSE(leaps.warnings.empty());
  EXPECT_NE(leaps.warnings[0].text.find("is time.step_s too long?"), std::string::npos) << leaps.warnings[0].text;

  const Result far = run({"mesh_molar", {"initial.position_m=[0,0,0.1]", "hand.z_N=1.5"}});
  ASSERT_NE(finding(far, "lost"), nullptr);
  EXPECT_NE(finding(far, "lost")->attempt.find("initial.position_m"), std::string::npos);
  EXPECT_EQ(far.warnings[0].text.find("time.step_s"), std::string::npos) << far.warnings[0].text;
}

/// Only who asks pays for it. Others are warned where numbers are not the law's doing.
TEST(Diagnosis, OfARunThatNobodyDiagnosesIsAWarning) {
  for (const auto& [override, rule] : {std::pair("rendering.friction.mu_f_s_per_m=1000", "friction"),
                                       {R"(rendering.reduction={"threshold":0.9})", "reduction"}}) {
    const Words overrides = {override};
    const char* const scene = rule == std::string_view("friction") ? "drag_molar" : "mesh_molar";
    const Result result = run_scenario(load_scenario(find_scenario(scene), overrides), std::nullopt, false);
    EXPECT_FALSE(result.diagnosis);
    EXPECT_EQ(std::ranges::count(result.warnings, rule, &Warning::kind), 1) << rule;
  }
}

}  // namespace
}  // namespace hapbench::diagnosis_test
