#include "scenarios/analysis/stability/run_stability.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench::run_stability_test {
namespace {

/// Checks that a tool that keeps bouncing below 30 Hz is not at rest, even if the rule allows its vibration above 30
/// Hz.
TEST(StabilityOf, OfSlowBouncesThatGoOnIsVibrating) {
  const ScenarioText plane = read_scenario_text(find_scenario("poke_plane"));
  const StabilityRule any_vibration{.max_vibration = 1.0};
  for (const auto& [zeta, verdict] : {std::pair("0", RunVerdict::vibrating), {"0.5", RunVerdict::stable}}) {
    const std::vector<std::string> fields = {R"(hand={"type":"force","z_N":-0.05})",
                                             "time.duration_s=4",
                                             "rendering.reduction=null",
                                             "rendering.algorithm=mean",
                                             "rendering.stiffness_N_per_m=5000",
                                             std::string("rendering.damping_ratio=") + zeta};
    const LoadedScenario loaded = load_scenario(plane, fields);
    EXPECT_EQ(stability_of(checked(loaded), make_shell(loaded.scenario, loaded.files), any_vibration).verdict, verdict)
        << zeta;
  }
}

/// Checks a soft hand that cannot pull the tool over a bump of the molar. The tool is at rest, so the loop is stable if
/// progress is not judged.
TEST(StabilityOf, OfAToolThatItsHandDoesNotMoveOnIsStableUnlessProgressIsJudged) {
  const std::vector<std::string> fields = {"hand.stiffness_N_per_m=100", "rendering.stiffness_N_per_m=66000"};
  const LoadedScenario loaded = load_scenario(read_scenario_text(find_scenario("drag_molar")), fields);
  const auto shell = make_shell(loaded.scenario, loaded.files);
  StabilityRule rule = rule_of(loaded.scenario);
  EXPECT_EQ(stability_of(checked(loaded), shell, rule).verdict, RunVerdict::stuck);
  rule.judges_progress = false;
  EXPECT_EQ(stability_of(checked(loaded), shell, rule).verdict, RunVerdict::stable);
}

/// Checks that every trial of an experiment counts: with this K, the subject that presses with 6 N passes through the
/// bottom of the hole, the other subject does not. The verdict does not depend on their order, and `run` has the same
/// outcome.
TEST(StabilityOf, AnExperimentIsThatOfItsWorstTrial) {
  const ScenarioText peg = read_scenario_text(find_scenario("vertical_peg_in_hole_shaped_stiffness"));
  const std::string gentle = R"({"press_N":1.6})", strong = R"({"press_N":6})";
  for (const auto& [subjects, verdict] : {std::pair(gentle + "," + gentle, RunVerdict::stable),
                                          {gentle + "," + strong, RunVerdict::went_through},
                                          {strong + "," + gentle, RunVerdict::went_through}}) {
    const std::vector<std::string> fields = {"hand.subjects=[" + subjects + "]",  "hand.trials=1",
                                             "hand.task.places_m=[[0,0,-0.005]]", R"(device={"type":"ideal"})",
                                             "rendering.stiffness_N_per_m=5000",  "time.duration_s=3"};
    const CheckedScenario scene = checked(load_scenario(peg, fields));
    const auto shell = make_shell(scene.scenario(), scene.files());
    EXPECT_EQ(stability_of(scene, shell, rule_of(scene.scenario())).verdict, verdict) << subjects;
    EXPECT_EQ(run_with_shell(scene, shell).end.outcome == Outcome::went_through, verdict == RunVerdict::went_through);
  }
}

}  // namespace
}  // namespace hapbench::run_stability_test
