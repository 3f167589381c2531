#include "scenarios/studies/worst_motion/adversary.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "results/io/json_text.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::adversary_test {
namespace {

Scenario scene(const std::string& algorithm, std::vector<std::string> overrides = {}) {
  overrides.push_back("rendering.algorithm=" + algorithm);
  return load_scenario(find_scenario("peg_in_hole_2d_shaped_stiffness"), overrides).scenario;
}

SearchOptions options(std::uint64_t evaluations, unsigned threads = 2) {
  SearchOptions options;
  options.evaluations = evaluations;
  options.jobs.threads = threads;
  return options;
}

std::string text_of(const SearchResult& found) {
  return json_text(effective_scenario(found.scenario, "."));
}

TEST(Adversary, FindsThatTheOriginalAlgorithmIsWorseThanStiffnessShaping) {
  // Opposite gradients make the original algorithm's force jump (thesis B.3.3); shaping was made against that (C.4.2).
  const SearchResult original = search_adversary(scene("original_averaging"), options(200));
  const SearchResult shaped = search_adversary(scene("shaped_stiffness"), options(200));
  EXPECT_GT(original.badness, 2.0 * original.at_rest);
  EXPECT_GT(original.badness, 10.0 * shaped.badness);
  EXPECT_GT(metric_of(original.run, "energy.created_sum_J").value(),
            0.1);  // [J]: a hundred times what a hand of 5 N puts in along 0.2 mm
}

TEST(Adversary, KeepsNinetyPercentWhileMinimising) {
  for (const Badness badness : {Badness::created, Badness::vibration}) {
    SearchOptions search = options(120);
    search.badness = badness;
    const SearchResult found = search_adversary(scene("normal_projection"), search);
    EXPECT_GE(found.badness, 0.9 * found.found);
    EXPECT_LE(found.trajectory.size(), search.bounds.waypoints);
    EXPECT_LE(found.trajectory.back().time, search.bounds.duration);
    EXPECT_LE(found.evaluations, 2 * search.evaluations + 2);
    std::uint64_t runs = 0;
    for (const auto& [outcome, count] : found.outcomes) runs += count;
    EXPECT_EQ(runs, search.evaluations);
    EXPECT_EQ(found.badness, badness_of(badness, found.run));
  }
}

TEST(Adversary, WritesAScenarioThatShowsWhatWasFound) {
  const SearchResult found = search_adversary(scene("original_averaging"), options(100));
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "found.json", text_of(found));
  const RunReport report = run_scenario(load_scenario(directory / "found.json"), std::nullopt, false);
  EXPECT_EQ(report.unmet, std::vector<std::string>{});
  EXPECT_EQ(report.summary.metrics.state_hash, found.run.metrics.state_hash);
  EXPECT_EQ(badness_of(Badness::created, report.summary), found.badness);
  // Its expectation is one that a tame algorithm fails.
  const LoadedScenario tame =
      load_scenario(directory / "found.json", std::vector<std::string>{"rendering.algorithm=mean"});
  EXPECT_FALSE(run_scenario(tame, std::nullopt, false).unmet.empty());
}

TEST(Adversary, IsTheSameForASeedWhateverTheNumberOfThreads) {
  const Scenario where = scene("tandpasta");
  const std::string one = text_of(search_adversary(where, options(60, 1)));
  EXPECT_EQ(text_of(search_adversary(where, options(60, 1))), one);
  EXPECT_EQ(text_of(search_adversary(where, options(60, 4))), one);
  SearchOptions other = options(60);
  other.seed = 2;
  EXPECT_NE(text_of(search_adversary(where, other)), one);
}

TEST(Adversary, FindsNoLessWithMoreEvaluations) {
  double last = 0.0;
  for (const std::uint64_t evaluations : {1u, 30u, 200u, 500u}) {
    const SearchResult found = search_adversary(scene("exact_shaping"), options(evaluations));
    EXPECT_GE(found.found, last) << evaluations;
    last = found.found;
  }
}

TEST(Adversary, SearchesTheBlockInSpace) {
  const Scenario block = load_scenario(find_scenario("drill_in_hole"), std::vector<std::string>{}).scenario;
  SearchOptions search = options(6);
  search.bounds.duration = 0.05;
  const SearchResult found = search_adversary(block, search);
  EXPECT_GE(found.evaluations, search.evaluations);
  EXPECT_TRUE(std::holds_alternative<BlockEnvironment>(found.scenario.environment));
  EXPECT_GE(found.badness, 0.0);
}

TEST(Adversary, SearchesAnySurfaceAndShowsWhatWasFound) {
  for (const char* name : {"poke_plane", "mesh_molar"}) {
    SCOPED_TRACE(name);
    const Scenario where = load_scenario(find_scenario(name), std::vector<std::string>{}).scenario;
    SearchOptions search = options(20);
    search.bounds.duration = 0.1;
    const SearchResult found = search_adversary(where, search);
    EXPECT_GT(found.run.metrics.steps_in_contact, 0u);
    EXPECT_GT(found.badness, 0.0);
    const test::TemporaryDirectory directory;
    test::write_plainly(directory / "found.json", json_text(effective_scenario(found.scenario, directory.path())));
    const RunReport report = run_scenario(load_scenario(directory / "found.json"), std::nullopt, false);
    EXPECT_EQ(report.unmet, std::vector<std::string>{});
    EXPECT_EQ(report.summary.metrics.state_hash, found.run.metrics.state_hash);
  }
}

TEST(SearchScene, SetsTheToolAgainstTheSurfaceAndAimsAroundIt) {
  const Scenario where =
      load_scenario(find_scenario("poke_plane"), std::vector<std::string>{"initial.position_m=[0.001,0,0.02]"})
          .scenario;
  const SearchScene scene = search_scene(where);
  // A flat tip above a plane touches at its height, to the 40 halvings.
  EXPECT_NEAR(scene.scenario.initial.position.z(), 0.0, 1e-12);
  EXPECT_NEAR(scene.scenario.initial.position.x(), 0.001, 1e-12);
  ASSERT_TRUE(scene.reach);
  EXPECT_NEAR(scene.reach->max.x(), 0.003, 1e-12);  // half of 4 mm, and the drill's diameter
  EXPECT_NEAR(scene.reach->min.z(), -0.001, 1e-12);
  const Trajectory far = {{0.0, 0.0, 0.0, Vec3(5.0, 0.0, -0.06)}, {0.1, 0.0, 0.0, Vec3(-5.0, 0.0, 0.0)}};
  const auto hand = std::get<ImpedanceHandFields>(with_trajectory(scene, far).hand);
  EXPECT_EQ(hand.target[0](0.0), 0.003) << "within reach, not 17 mm away";
  EXPECT_EQ(hand.target[0](0.1), -0.003);
  EXPECT_NEAR(hand.target[2](0.0), -0.0002, 1e-12) << "0.06 N of 300 N/m";
}

TEST(SearchScene, LeavesAToolInAHoleWhereItIs) {
  const Scenario hole = scene("mean");
  const SearchScene search = search_scene(hole);
  EXPECT_EQ(search.scenario.initial.position, hole.initial.position);
  EXPECT_FALSE(search.reach);
  EXPECT_TRUE(search.planar);
}

TEST(Adversary, IsRefusedWhereThereIsNoSurface) {
  const Scenario springs = load_scenario(find_scenario("single_spring")).scenario;
  const auto no_surface = test::input_error_of([&] { search_adversary(springs, options(1)); });
  ASSERT_TRUE(no_surface);
  EXPECT_EQ(no_surface->place(), "/environment/type");
  const auto too_fine = test::input_error_of([&] {
    search_adversary(scene("mean", {"time.step_s=1e-9", "time.steps=2000"}), options(1));
  });
  ASSERT_TRUE(too_fine);
  EXPECT_EQ(too_fine->place(), "/time/step_s");
  const Scenario led = scene("mean", {R"(motion={"position":{"type":"prescribed","x_m":0,"y_m":0,"z_m":0}})"});
  const auto error = test::input_error_of([&] { search_adversary(led, options(1)); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place(), "/motion/position/type");
}

/// Rounding to 0.1 mrad may add half of it.
void expect_within(const Trajectory& trajectory, const TrajectoryBounds& bounds, double tilt, bool planar) {
  ASSERT_GE(trajectory.size(), 2u);
  EXPECT_EQ(trajectory.front().time, 0.0);
  EXPECT_EQ(trajectory.front().tilt, tilt);
  EXPECT_LE(trajectory.back().time, bounds.duration + 0.0005);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Waypoint& w = trajectory[i];
    EXPECT_LE(w.force.norm(), bounds.force * (1.0 + 1e-12));
    if (planar) {
      EXPECT_EQ(w.force.z(), 0.0);
      EXPECT_EQ(w.azimuth, trajectory.front().azimuth);
    }
    if (i == 0) continue;
    const Waypoint& last = trajectory[i - 1];
    ASSERT_GT(w.time, last.time);
    EXPECT_LE(std::abs(w.tilt), bounds.tilt + 5e-5);
    EXPECT_LE(std::abs(w.tilt - last.tilt), bounds.rate * (w.time - last.time) + 1.01e-4);
    EXPECT_LE(std::abs(w.azimuth - last.azimuth), bounds.rate * (w.time - last.time) + 1.01e-4);
  }
}

TEST(TrajectoryDraws, StayWithinTheBoundsHoweverTheyAreChanged) {
  const TrajectoryBounds bounds;
  Random random(1);
  for (const bool planar : {true, false}) {
    const TrajectoryDraws draws(bounds, planar, 0.1, 0.3);
    expect_within(draws.at_rest(), bounds, 0.1, planar);
    for (int i = 0; i < 200; ++i) {
      Trajectory trajectory = draws.random(random);
      expect_within(trajectory, bounds, 0.1, planar);
      for (int k = 0; k < 20; ++k) {
        trajectory = draws.changed(std::move(trajectory), random.uniform(0.0, 3.0), random);
        expect_within(trajectory, bounds, 0.1, planar);
      }
      for (std::size_t k = 0; k < draws.simplifications(trajectory); ++k) {
        if (const auto simpler = draws.simplified(trajectory, k)) expect_within(*simpler, bounds, 0.1, planar);
      }
    }
  }
}

TEST(TrajectoryDraws, SimplifyUntilNothingIsLeft) {
  const TrajectoryDraws draws({}, false, 0.0, 0.0);
  Random random(2);
  Trajectory trajectory = draws.random(random);
  for (int rounds = 0; rounds < 1000; ++rounds) {
    bool simpler = false;
    for (std::size_t i = 0; i < draws.simplifications(trajectory); ++i) {
      if (const auto next = draws.simplified(trajectory, i)) {
        trajectory = *next;
        simpler = true;
        break;
      }
    }
    if (!simpler) break;
  }
  EXPECT_EQ(trajectory.size(), 2u);
  for (const Waypoint& w : trajectory) {
    EXPECT_EQ(w.tilt, 0.0);
    EXPECT_EQ(w.azimuth, 0.0);
    EXPECT_EQ(w.force, Vec3(0, 0, 0));
  }
  EXPECT_LE(trajectory.back().time, 0.002);
}

}  // namespace
}  // namespace hapbench::adversary_test
