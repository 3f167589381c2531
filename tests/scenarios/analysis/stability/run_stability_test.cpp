#include "scenarios/analysis/stability/run_stability.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/checked_scenario.hpp"
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

}  // namespace
}  // namespace hapbench::run_stability_test
