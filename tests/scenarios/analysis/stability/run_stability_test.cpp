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

/// A tool that keeps bouncing below 30 Hz is not at rest, however little it vibrates.
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

}  // namespace
}  // namespace hapbench::run_stability_test
