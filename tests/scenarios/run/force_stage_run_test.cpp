#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "results/summary/summary.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "tests/scenarios/studies/precision/results.hpp"
#include "tests/scenarios/support/errors.hpp"

/// Force stages named by a scenario.
namespace hapbench::force_stage_run_test {
namespace {

using test::bundled;

std::string refusal(const char* scene, const std::string& stage) {
  const auto error = test::input_error_of([&] { bundled(scene, {"rendering.force_stage=" + stage}); });
  return error ? error->what() : "";
}

TEST(ForceStage, IsRefusedWithAReason) {
  EXPECT_NE(
      refusal("tap_wall", R"({"type":"actuator_limited_passivity"})")
          .find(
              "/rendering/force_stage/max_damping_N_s_per_m: got null; allowed with device \"impedance\" or a prescribed"),
      std::string::npos);
  EXPECT_NO_THROW(bundled(
      "tap_wall", {R"(rendering.force_stage={"type":"actuator_limited_passivity","max_damping_N_s_per_m":5})"}));
  EXPECT_NE(refusal("drag_molar", R"({"type":"energy_tank","capacity_J":-1})").find("capacity_J: got -1; allowed"),
            std::string::npos);
}

TEST(ForceStage, IsWrittenAsItWasRead) {
  const auto stage_of = [](const Scenario& scenario) {
    return effective_scenario(scenario, "")["rendering"].value("force_stage", Json());
  };
  EXPECT_EQ(stage_of(bundled("drag_molar", {})), Json());
  for (const char* stage :
       {R"({"type":"energy_tank","capacity_J":0.5,"initial_J":0.25})",
        R"({"type":"actuator_limited_passivity","max_force_N":[1.0,2.0,3.0],"max_damping_N_s_per_m":4.0})"}) {
    EXPECT_EQ(stage_of(bundled("drag_molar", {std::string("rendering.force_stage=") + stage})), Json::parse(stage));
  }
}

/// Without damping and friction, all that the ledger of energies finds damped is what the stage took.
TEST(ForceStage, ReportsWhatItTakes) {
  LoadedScenario loaded;
  loaded.scenario =
      bundled("tap_wall", {R"(rendering.force_stage={"type":"energy_tank","capacity_J":1e-6})", "record.energy=true"});
  const auto taken = metric_of(run_scenario(loaded, std::nullopt, false).summary, "force_stage.taken_J");
  const auto share = metric_of(run_scenario(loaded, std::nullopt, false).summary, "force_stage.changed_share");
  ASSERT_TRUE(taken && share);
  EXPECT_GT(*taken, 0.0);
  EXPECT_GT(*share, 0.0);
  EXPECT_LT(*share, 1.0);
  EXPECT_NEAR(*metric_of(run_scenario(loaded, std::nullopt, false).summary, "energy.damping_J"), -*taken,
              1e-9 * *taken);
  loaded.scenario.rendering.force_stage.reset();
  EXPECT_FALSE(metric_of(run_scenario(loaded, std::nullopt, false).summary, "force_stage.taken_J"));
}

}  // namespace
}  // namespace hapbench::force_stage_run_test
