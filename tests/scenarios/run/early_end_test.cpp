#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::early_end_test {
namespace {

// Tests runs with RunLength::until_failure, which batches of runs use. Such a run ends at a failure that no later step
// can undo.

bool has_values(const Result& run) {
  return std::ranges::any_of(run.metrics, [](const Metric& m) { return number_of(m.value).has_value(); });
}

/// Compares the run of a scenario that may end early with its full run. If the run ends early, counts its outcome in
/// `early`.
void compare(const CheckedScenario& scene, std::map<Outcome, int>& early) {
  const Result full = run_scenario(scene, {}, false);
  const Result run = run_scenario(scene, {}, false, nullptr, Diagnose::nothing, {}, RunLength::until_failure);
  EXPECT_EQ(outcome_name(run.end.outcome), outcome_name(full.end.outcome));
  EXPECT_EQ(run.expected, full.expected);
  EXPECT_FALSE(full.end.ended_at);
  if (!run.end.ended_at) {
    EXPECT_EQ(run.state_hash, full.state_hash);
    EXPECT_EQ(summary_json(run).dump(), summary_json(full).dump());
    return;
  }
  ++early[run.end.outcome];
  EXPECT_FALSE(run.expected) << "an expected outcome has metrics";
  EXPECT_LE(run.end.rows, full.end.rows);
  EXPECT_LE(*run.end.ended_at, full.duration);
  EXPECT_FALSE(has_values(run)) << "values of a part of the run";
}

/// Checks every bundled scenario with its own gains, and with gains and forces that make the tool sink in, fly off and
/// diverge.
TEST(EarlyEnd, HasTheOutcomeOfTheFullRun) {
  // Both runs of a scenario have at most this many steps. In some scenarios the failure would come later. Both runs
  // must then have the same outcome as well.
  constexpr std::int64_t kMaxSteps = 1500;
  std::map<Outcome, int> early;
  for (const auto& [name, group, file] : bundled_scenarios()) {
    const LoadedScenario own = load_scenario(file);
    // A run with many trials never ends early, so skip it.
    if (std::holds_alternative<TrackingHandFields>(own.scenario.hand)) continue;
    const std::string steps = "time.steps=" + std::to_string(std::min(kMaxSteps, own.scenario.time.steps));
    const double K = own.scenario.rendering.stiffness;
    for (const double factor : {1.0, 0.01, 300.0}) {
      SCOPED_TRACE(name + ", K times " + std::to_string(factor));
      std::vector<std::string> overrides = {steps, "record={}",
                                            "rendering.stiffness_N_per_m=" + std::to_string(factor * K)};
      const CheckedScenario scene = checked(load_scenario(file, overrides));
      compare(scene, early);
    }
  }
  EXPECT_GT(early[Outcome::went_through], 20);
  EXPECT_GT(early[Outcome::diverges], 10);
}

/// Returns the scenario of a tool of 1 mm at a plane of 10 mm, changed by a patch. A hand pushes the tool onto the
/// plane.
CheckedScenario above_plane(const char* patch) {
  Json json = Json::parse(R"({
    "time": {"step_s": 0.0005, "steps": 2000},
    "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0005},
    "tool": {"diameter_m": 0.001}, "initial": {"position_m": [0, 0, 0]},
    "hand": {"type": "force", "z_N": -0.5}, "rendering": {"mass_kg": 0.1}
  })");
  json.merge_patch(Json::parse(patch));
  return checked(read_scenario(json, test::data_directory()));
}

Result ended(const char* patch) {
  return run_scenario(above_plane(patch), {}, false, nullptr, Diagnose::nothing, {}, RunLength::until_failure);
}

TEST(EarlyEnd, LeavesOnlyIfNoHandBringsTheToolBack) {
  const struct {
    const char* patch;
    std::optional<Outcome> early;
  } cases[] = {{R"({"hand": {"x_N": 8}})", Outcome::lost_contact},
               {R"({"hand": {"z_N": 1}})", Outcome::lost_contact},
               {R"({"hand": {"z_N": 1}, "initial": {"position_m": [0, 0, 0.003]}})", Outcome::no_contact},
               {R"({"hand": null, "initial": {"position_m": [0, 0, 0.003], "velocity_m_per_s": [0, 0, 0.2]}})",
                Outcome::no_contact},
               // The tool flies off and falls back, because the force points towards the plane.
               {R"({"initial": {"position_m": [0, 0, 0.003], "velocity_m_per_s": [0, 0, 0.6]}})", {}},
               // The hand's force changes its sign, or the hand's spring pulls the tool back.
               {R"({"hand": {"z_N": {"type": "waypoints", "points": [[0, 1], [0.5, -4]]}}})", {}},
               {R"({"hand": {"type": "impedance", "z_N": null, "stiffness_N_per_m": 100, "damping_N_s_per_m": 1,
                    "target": {"x_m": 0, "y_m": 0, "z_m": 0.05}}})",
                {}},
               // A device has a handle, which moves independently of the tool.
               {R"({"hand": {"x_N": 8}, "device": {"type": "impedance", "handle_mass_kg": 0.1}})", {}}};
  for (const auto& [patch, early] : cases) {
    SCOPED_TRACE(patch);
    const Result run = ended(patch);
    EXPECT_EQ(run.end.outcome, run_scenario(above_plane(patch), {}, false).end.outcome);
    // If the tool may come back, the run does not end early because the tool left the surface. It may end early because
    // the tool went through the surface.
    if (!early && run.end.ended_at) {
      EXPECT_EQ(run.end.outcome, Outcome::went_through);
    }
    if (!early) continue;
    EXPECT_TRUE(run.end.ended_at);
    EXPECT_EQ(run.end.outcome, *early);
    EXPECT_LT(run.end.rows, 2000u);
  }
}

/// Checks a tool that is pushed through the plane and moves on until the run counts as diverged. A run that ends early
/// has the outcome of the full run.
TEST(EarlyEnd, ToolThatWentThroughMayStillDiverge) {
  const char* const shot = R"({"hand": {"z_N": -1e6}, "time": {"steps": 20000}})";
  const Result run = ended(shot), full = run_scenario(above_plane(shot), {}, false);
  ASSERT_EQ(full.end.outcome, Outcome::diverges);
  EXPECT_EQ(run.end.outcome, Outcome::diverges);
  EXPECT_LT(*run.end.ended_at, 0.01) << "the passage";
  EXPECT_LT(run.end.rows, full.end.rows);
}

TEST(EarlyEnd, IsNotForOutcomesThatAreExpectedOrScripted) {
  const char* const expected = R"({"hand": {"z_N": -50}, "rendering": {"stiffness_N_per_m": 10},
                                   "expect": {"outcome": "went_through", "metrics": {"force_max_N": {"min": 0}}}})";
  const Result run = ended(expected);
  EXPECT_EQ(run.end.outcome, Outcome::went_through);
  EXPECT_TRUE(run.expected);
  EXPECT_FALSE(run.end.ended_at);
  const char* const scripted = R"({"initial": null, "hand": null, "motion": {"position": {"type": "prescribed",
      "x_m": 0, "y_m": 0, "z_m": {"type": "ramp", "start": 0, "rate_per_s": -0.01}}}})";
  EXPECT_EQ(ended(scripted).end.outcome, Outcome::went_through);
  EXPECT_FALSE(ended(scripted).end.ended_at);
}

/// Checks the summary and the tables of a run that ended early.
TEST(EarlyEnd, HasATimeAndNoNumbers) {
  const Result run = ended(R"({"hand": {"z_N": -50}, "rendering": {"stiffness_N_per_m": 10}})");
  ASSERT_TRUE(run.end.ended_at);
  const Json summary = summary_json(run);
  EXPECT_EQ(summary["ended_at_s"], *run.end.ended_at);
  EXPECT_EQ(summary["steps"], run.end.rows);
  EXPECT_TRUE(summary["metrics"]["force_max_N"].is_null());
  EXPECT_TRUE(summary["tolerances"].empty());
  ASSERT_EQ(run.unmet.size(), 1u) << "the outcome, and no missing metric";
  ASSERT_EQ(run.warnings.size(), 1u);
  EXPECT_NE(run.warnings[0].text.find("the run ended there"), std::string::npos) << run.warnings[0].text;
}

}  // namespace
}  // namespace hapbench::early_end_test
