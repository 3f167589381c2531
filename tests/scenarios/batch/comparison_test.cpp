#include "scenarios/batch/comparison.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/motions.hpp"
#include "scenarios/scene/named_files.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::comparison_test {
namespace {

namespace fs = std::filesystem;

class ComparisonOf : public testing::Test {
 protected:
  fs::path write(const std::string& name, const Json& scenario) const {
    test::write_plainly(directory_ / name, scenario.dump());
    return directory_ / name;
  }
  /// Returns a question with two scenes, the second with random springs.
  ComparisonQuestion two_scenes() const {
    Json springs = test::minimal_scenario("springs");
    springs["environment"] = {{"type", "springs"}, {"random", {{"count", 5}}}};
    springs["initial"] = {{"position_m", {0.001, 0.0, 0.0}}};
    springs["seed"] = 40;
    return {.scenarios = {write("plane.json", test::minimal_scenario("plane")), write("springs.json", springs)},
            .algorithms = {"mean", "summation"},
            .seeds = 3};
  }
  std::string refused(const ComparisonQuestion& question) const {
    const auto error = test::input_error_of([&] { planned(question); });
    return error ? error->what() : "";
  }
  test::TemporaryDirectory directory_;
};

TEST_F(ComparisonOf, SeveralScenesNumbersRunsSceneByScene) {
  const Comparison comparison = planned(two_scenes());
  ASSERT_EQ(comparison.size(), 12u);
  EXPECT_EQ(comparison.folder(0), "plane/mean/seed_0");
  EXPECT_EQ(comparison.folder(5), "plane/summation/seed_2");
  EXPECT_EQ(comparison.folder(11), "springs/summation/seed_2");
  EXPECT_EQ(comparison.load(11).scenario.seed, 42);
  EXPECT_EQ(comparison.load(11).scenario.rendering.algorithm, "summation");
  ComparisonQuestion one = two_scenes();
  one.scenarios.pop_back();
  one.seeds = 1;
  EXPECT_EQ(planned(one).folder(1), "summation");
}

TEST_F(ComparisonOf, JitteredScenesStartFromOnePositionForEachSeed) {
  ComparisonQuestion question = two_scenes();
  question.jitter = 1e-4;
  const Comparison comparison = planned(question);
  const auto start = [&](std::size_t run) { return comparison.load(run).scenario.initial.position; };
  for (std::size_t seed = 0; seed < 3; ++seed) {
    // The norm is the root of a sum of three rounded squares, so its error is a few units in the last place.
    EXPECT_NEAR(start(seed).norm(), 1e-4, 1e-18);
    EXPECT_EQ(start(seed), start(3 + seed)) << "the other algorithm";
    EXPECT_NE(start(seed), start((seed + 1) % 3));
    // The springs lie in the plane z = 0, so the jitter keeps the start position in this plane. The sum of the jitter
    // and 1e-3 m is rounded by up to 1e-19 m.
    EXPECT_EQ(start(6 + seed).z(), 0.0);
    EXPECT_NEAR((start(6 + seed) - Vec3(0.001, 0.0, 0.0)).norm(), 1e-4, 1e-18);
  }
}

TEST_F(ComparisonOf, JitterShiftsAPrescribedPathAsAWhole) {
  Json script = test::minimal_scenario("plane");
  script["motion"] = {{"position",
                       {{"type", "prescribed"},
                        {"x_m", {{"type", "ramp"}, {"start", 0.0}, {"rate_per_s", 0.01}}},
                        {"y_m", {{"type", "sine"}, {"mean", 0.0}, {"amplitude", 1e-3}, {"period_s", 1.0}}},
                        {"z_m", {{"type", "waypoints"}, {"points", {{0, 0.001}, {1, -0.001}}}}}}}};
  const ComparisonQuestion question{
      .scenarios = {write("script.json", script)}, .algorithms = {"mean"}, .seeds = 3, .jitter = 1e-4};
  const Comparison comparison = planned(question);
  const auto place = [](const Scenario& scenario, double t) -> Vec3 {
    return make_motion(scenario, NamedFiles(scenario))->position_at(t);
  };
  const Scenario own = load_scenario(question.scenarios[0]).scenario;
  for (std::size_t seed = 0; seed < 3; ++seed) {
    const Scenario shifted = comparison.load(seed).scenario;
    const Vec3 shift = place(shifted, 0.0) - place(own, 0.0);
    EXPECT_NEAR(shift.norm(), 1e-4, 1e-17);
    for (const double t : {0.3, 0.7, 2.0}) EXPECT_NEAR((place(shifted, t) - place(own, t) - shift).norm(), 0.0, 1e-16);
  }
}

TEST_F(ComparisonOf, WhatCannotBeComparedNamesTheFile) {
  ComparisonQuestion question = two_scenes();
  Json script = test::minimal_scenario("plane");
  script["motion"] = {{"position", {{"type", "prescribed"}, {"x_m", 0.0}, {"y_m", 0.0}, {"z_m", 0.0}}}};
  question.scenarios.push_back(write("script.json", script));
  EXPECT_NO_THROW(planned(question));
  // A prescribed path is shifted. With a reference force, which belongs to the path, the shift is rejected.
  question.jitter = 1e-4;
  EXPECT_NO_THROW(planned(question));
  script["reference_force"] = {{"z_N", 1.0}};
  question.scenarios.back() = write("script.json", script);
  EXPECT_NE(refused(question).find("script.json: /reference_force: "), std::string::npos) << refused(question);
  question = two_scenes();
  fs::create_directory(directory_ / "copy");
  question.scenarios.push_back(write("copy/plane.json", test::minimal_scenario("plane")));
  EXPECT_NE(refused(question).find("a second scenario named \"plane\"; allowed: "), std::string::npos);
  question = two_scenes();
  question.overrides = {"seed=9007199254740991"};  // 2^53 - 1: two larger seeds exceed the limit
  EXPECT_NE(refused(question).find("/seed: got 9007199254740991; allowed: at most "), std::string::npos);
  question.seeds = 1'000'000;
  EXPECT_NE(refused(question).find("= 4000000 runs; allowed: at most 1000000"), std::string::npos);
}

TEST_F(ComparisonOf, ScenesRemovesWhatAnEarlierOneLeftAndNothingElse) {
  const fs::path out = directory_ / "out";
  for (const char* name : {"ranking.csv", "plane/comparison.csv", "plane/mean/seed_1/summary.json",
                           "plane/proxy/summary.json", "plane/proxy/notes.txt", "plane/mine/summary.json"}) {
    fs::create_directories((out / name).parent_path());
    test::write_plainly(out / name, "x");
  }
  remove_earlier_comparison(out, planned(two_scenes()));
  EXPECT_EQ(test::names_below(out), (std::vector<std::string>{"plane/mine/summary.json", "plane/proxy/notes.txt"}));
  EXPECT_FALSE(fs::exists(out / "plane/mean"));
}

/// Checks that only two shells are built for three scenes. Two scenes have the same block and different start
/// positions; the third scene has a block with another grid. Checks runs with one thread and with four threads.
TEST_F(ComparisonOf, AnyScenesBuildsEachDistinctShellOnce) {
  for (const unsigned jobs : {1u, 4u}) {
    Json scene = test::minimal_scenario("block_with_hole");
    ComparisonQuestion question{.scenarios = {}, .algorithms = {"mean", "summation", "proxy"}, .seeds = 4};
    for (const auto& [name, grid] : {std::pair{"a", 1e-4}, {"b", 2e-4}, {"c", 1e-4}}) {
      scene["environment"]["grid_m"] = grid + 1e-6 * jobs;  // shells that no earlier run has cached
      scene["initial"]["position_m"] = {0.0, 0.0, name[0] == 'c' ? 1e-3 : 0.0};
      question.scenarios.push_back(write(std::string(name) + ".json", scene));
    }
    const Comparison comparison = planned(question);
    const std::size_t before = shared_cache().made();
    run_all(comparison.scenes, {.threads = jobs, .label = ""});
    EXPECT_EQ(shared_cache().made() - before, 2u) << jobs << " jobs";
  }
}

}  // namespace
}  // namespace hapbench::comparison_test
