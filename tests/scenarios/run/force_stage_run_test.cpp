#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "algorithms/registry.hpp"
#include "algorithms/stages/force_stage.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "tests/scenarios/studies/precision/results.hpp"
#include "tests/scenarios/support/errors.hpp"

/// Force stages named by a scenario.
namespace hapbench::force_stage_run_test {
namespace {

using test::bundled;

class Forces final : public Observer {
 public:
  void on_step(const StepRecord& r) noexcept override {
    rendered.push_back(r.force.rendered);
    positions.push_back(r.tool.pose.position);
  }
  std::vector<Vec3> rendered, positions;
};

Forces forces_of(const Scenario& scenario) {
  Forces forces;
  Simulation simulation(simulation_config(scenario), assemble(scenario), {&forces});
  run_to_end(simulation);
  return forces;
}

class Idle final : public ForceStage {
 public:
  void prepare(const HapbenchStageRun&) override {}
  void reset() noexcept override {}
  Vec3 force(const HapbenchStageStep& step) noexcept override { return Vec3::Map(step.force); }
};

TEST(ForceStage, ThatIsIdleMovesNoBitOfAnyAlgorithm) {
  add_force_stage("idle", [](const std::string&) { return std::make_unique<Idle>(); });
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const char* controlled : {"false", "true"}) {
      SCOPED_TRACE(testing::Message() << algorithm.info->name << " " << controlled);
      std::vector<std::string> overrides = {"rendering.algorithm=" + std::string(algorithm.info->name),
                                            "time.duration_s=0.2",
                                            "rendering.passivity_controller=" + std::string(controlled)};
      const Forces bare = forces_of(bundled("drag_molar", overrides));
      overrides.emplace_back(R"(rendering.force_stage={"type":"added","name":"idle"})");
      const Forces with = forces_of(bundled("drag_molar", overrides));
      EXPECT_EQ(bare.rendered, with.rendered);
      EXPECT_EQ(bare.positions, with.positions);
    }
  }
}

std::string plugin(const std::string& file, const std::string& config) {
  return R"(rendering.force_stage={"type":"plugin","file":")" HAPBENCH_TEST_PLUGINS "/" + file + R"(","config":)" +
         config + "}";
}

TEST(ForceStage, InCIsItsLowPass) {
  const std::vector<std::string> pressed = {
      R"(hand={"type":"none"})", "time.duration_s=0.05",
      R"(motion.position={"type":"prescribed","x_m":0,"y_m":0,"z_m":{"type":"sine","mean":0,"phase_rad":0,"amplitude":1e-5,"period_s":0.02}})"};
  auto overrides = pressed;
  overrides.push_back(plugin("soft_landing.so", R"({"cutoff_Hz":100})"));
  const Scenario scenario = bundled("poke_plane", overrides);
  const Forces law = forces_of(bundled("poke_plane", pressed)), soft = forces_of(scenario);
  const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * 100.0 * scenario.time.step);
  Vec3 last = Vec3::Zero();
  double difference = 0.0;
  ASSERT_EQ(law.rendered.size(), soft.rendered.size());
  for (std::size_t k = 0; k < law.rendered.size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      const double f = law.rendered[k][i];
      last[i] += std::abs(f) > std::abs(last[i]) ? share * (f - last[i]) : f - last[i];
    }
    // Roundings of the recursion, which forgets them.
    ASSERT_NEAR((soft.rendered[k] - last).norm(), 0.0, 1e-14 * (1.0 + last.norm())) << k;
    difference = std::max(difference, (law.rendered[k] - soft.rendered[k]).norm());
  }
  EXPECT_GT(difference, 0.01);
}

TEST(ForceStage, ThatFailsEndsTheRunAndSaysWhy) {
  const auto fault_of = [](const char* how) {
    LoadedScenario loaded;
    loaded.scenario =
        bundled("poke_plane", {"time.steps=20", plugin("hostile_stage.so", std::string("{\"how\":\"") + how + "\"}")});
    const RunSummary summary = run_scenario(loaded, std::nullopt, false).summary;
    EXPECT_EQ(summary.result.outcome, Outcome::diverges) << how;
    return summary.result.divergence.fault + " at " + std::to_string(summary.result.divergence.step);
  };
  EXPECT_EQ(fault_of("throws"), "hostile_stage fails: row 5 at 5");
  EXPECT_EQ(fault_of("odd"), "hostile_stage fails: unknown error at 5");
  EXPECT_EQ(fault_of("nan"), "hostile_stage fails: its force is not finite at 0");
  EXPECT_EQ(fault_of("forgets"), "hostile_stage fails: its force is not finite at 0");
  EXPECT_EQ(fault_of("beyond"), "hostile_stage fails: it writes beyond its force at 0");
  EXPECT_EQ(fault_of("beyond before"), "hostile_stage fails: it writes beyond its force at 0");
  const auto unmade = test::input_error_of(
      [] { require_force_stage(bundled("poke_plane", {plugin("hostile_stage.so", R"({"how":"unmade"})")})); });
  ASSERT_TRUE(unmade);
  EXPECT_STREQ(unmade->what(), "/rendering/force_stage/config: hostile_stage fails: the oven is cold");
}

std::string refusal(const char* scene, const std::string& stage) {
  const auto error = test::input_error_of([&] {
    const Scenario scenario = bundled(scene, {"rendering.force_stage=" + stage});
    force_stage_library(scenario);
  });
  return error ? error->what() : "";
}

TEST(ForceStage, IsRefusedWithAReason) {
  EXPECT_NE(refusal("drag_molar", R"({"type":"added","name":"nobody"})")
                .find("/rendering/force_stage/name: got \"nobody\"; allowed: stages that this process has added"),
            std::string::npos);
  EXPECT_NE(
      refusal("tap_wall", R"({"type":"actuator_limited_passivity"})")
          .find(
              "/rendering/force_stage/max_damping_N_s_per_m: got null; allowed with device \"impedance\" or a prescribed"),
      std::string::npos);
  EXPECT_NO_THROW(bundled(
      "tap_wall", {R"(rendering.force_stage={"type":"actuator_limited_passivity","max_damping_N_s_per_m":5})"}));
  EXPECT_NE(refusal("drag_molar", R"({"type":"energy_tank","capacity_J":-1})").find("capacity_J: got -1; allowed"),
            std::string::npos);
  EXPECT_NE(refusal("drag_molar", R"({"type":"plugin","file":"none.so"})").find("cannot be loaded as a force stage"),
            std::string::npos);
  EXPECT_NE(refusal("drag_molar", R"({"type":"plugin","file":")" HAPBENCH_TEST_PLUGINS R"(/sphere.so"})")
                .find("is no force stage: it has no function \"hapbench_force_stage\" (hapbench_force_stage.h)"),
            std::string::npos);
}

TEST(ForceStage, IsWrittenAsItWasRead) {
  add_force_stage("idle", [](const std::string&) { return std::make_unique<Idle>(); });
  const auto stage_of = [](const Scenario& scenario) {
    return effective_scenario(scenario, "")["rendering"].value("force_stage", Json());
  };
  EXPECT_EQ(stage_of(bundled("drag_molar", {})), Json());
  for (const char* stage :
       {R"({"type":"energy_tank","capacity_J":0.5,"initial_J":0.25})",
        R"({"type":"actuator_limited_passivity","max_force_N":[1.0,2.0,3.0],"max_damping_N_s_per_m":4.0})",
        R"({"type":"added","name":"idle","config":{"b":[1,2]}})"}) {
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
