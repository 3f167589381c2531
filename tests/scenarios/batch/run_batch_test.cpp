#include "scenarios/batch/run_batch.hpp"

#include <gtest/gtest.h>

#include <set>

#include "scenarios/run/assemble.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::run_batch_test {
namespace {

namespace fs = std::filesystem;
using test::input_error_of;

class BatchPlanOf : public testing::Test {
 protected:
  fs::path write(const std::string& name, const Json& scenario) const {
    test::write_plainly(directory_ / name, scenario.dump());
    return directory_ / name;
  }
  /// Two scenes, the second with random springs.
  BatchDefinition two_scenes() const {
    Json springs = test::minimal_scenario("springs");
    springs["environment"] = {{"type", "springs"}, {"random", {{"count", 5}}}};
    springs["initial"] = {{"position_m", {0.001, 0.0, 0.0}}};
    springs["seed"] = 40;
    BatchDefinition definition;
    definition.scenarios = {write("plane.json", test::minimal_scenario("plane")), write("springs.json", springs)};
    definition.algorithms = {"mean", "summation"};
    definition.seeds = 3;
    return definition;
  }
  test::TemporaryDirectory directory_;
};

TEST_F(BatchPlanOf, SeveralScenesNumbersRunsSceneByScene) {
  const BatchPlan plan = plan_batch(two_scenes());
  ASSERT_EQ(plan.size(), 12u);
  EXPECT_EQ(plan.names, (std::vector<std::string>{"plane", "springs"}));
  std::set<fs::path> directories;
  for (std::size_t i = 0; i < plan.size(); ++i) directories.insert(run_directory(plan, i));
  EXPECT_EQ(directories.size(), plan.size());
  EXPECT_EQ(run_directory(plan, 0), "plane/mean/seed_0");
  EXPECT_EQ(run_directory(plan, 5), "plane/summation/seed_2");
  EXPECT_EQ(run_directory(plan, 11), "springs/summation/seed_2");
  EXPECT_EQ(scenario_of(plan, 11).scenario.seed, 42);
  EXPECT_EQ(scenario_of(plan, 11).scenario.rendering.algorithm, "summation");
  EXPECT_EQ(scenario_directory(plan, 1), "springs");
}

TEST_F(BatchPlanOf, OneSceneAndSeedHasAFolderForEachAlgorithm) {
  BatchDefinition definition = two_scenes();
  definition.scenarios.pop_back();
  definition.seeds = 1;
  const BatchPlan plan = plan_batch(definition);
  EXPECT_EQ(run_directory(plan, 1), "summation");
  EXPECT_EQ(scenario_directory(plan, 0), "");
}

TEST_F(BatchPlanOf, EqualEnvironmentsSharesThem) {
  BatchDefinition definition = two_scenes();
  Json other = test::minimal_scenario("plane");
  other["initial"] = {{"position_m", {0.0, 0.0, 0.001}}};
  definition.scenarios.push_back(write("other.json", other));
  const BatchPlan plan = plan_batch(definition);
  const auto shell_of = [&plan](std::size_t scenario) {
    return make_shell(scenario_of(plan, scenario * plan.definition.algorithms.size() * plan.definition.seeds).scenario);
  };
  EXPECT_EQ(shell_of(0), shell_of(2));
  EXPECT_NE(shell_of(0), shell_of(1));
}

TEST_F(BatchPlanOf, JitteredScenesStartFromOnePlaceForEachSeed) {
  BatchDefinition definition = two_scenes();
  definition.jitter = 1e-4;
  const BatchPlan plan = plan_batch(definition);
  const auto start = [&plan](std::size_t run) { return scenario_of(plan, run).scenario.initial.position; };
  for (std::size_t seed = 0; seed < 3; ++seed) {
    // Norms of sums of three rounded squares are exact to a few units in the last place.
    EXPECT_NEAR(start(seed).norm(), 1e-4, 1e-18);
    EXPECT_EQ(start(seed), start(3 + seed)) << "the other algorithm";
    EXPECT_NE(start(seed), start((seed + 1) % 3));
    // Springs in the plane stay there. Adding to 1e-3 rounds by up to 1e-19.
    EXPECT_EQ(start(6 + seed).z(), 0.0);
    EXPECT_NEAR((start(6 + seed) - Vec3(0.001, 0.0, 0.0)).norm(), 1e-4, 1e-18);
  }
}

TEST_F(BatchPlanOf, PrescribedPlacesRefusesJitter) {
  Json scenario = test::minimal_scenario("plane");
  scenario["motion"] = {{"position", {{"type", "prescribed"}, {"x_m", 0.0}, {"y_m", 0.0}, {"z_m", 0.0}}}};
  BatchDefinition definition = two_scenes();
  definition.scenarios.push_back(write("script.json", scenario));
  EXPECT_NO_THROW(plan_batch(definition));
  definition.jitter = 1e-4;
  const auto error = input_error_of([&] { plan_batch(definition); });
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("script.json: /motion/position: "), std::string::npos) << error->what();
}

TEST_F(BatchPlanOf, WrongInputSaysWhichFile) {
  const auto message = [](const BatchDefinition& definition) {
    const auto error = input_error_of([&] { plan_batch(definition); });
    return error ? std::string(error->what()) : "";
  };
  BatchDefinition definition = two_scenes();
  Json bad = test::minimal_scenario("plane");
  bad["tyme"] = 1;
  definition.scenarios.push_back(write("bad.json", bad));
  EXPECT_NE(message(definition).find("bad.json: /tyme: unknown field"), std::string::npos) << message(definition);
  definition = two_scenes();
  fs::create_directory(directory_ / "copy");
  definition.scenarios.push_back(write("copy/plane.json", test::minimal_scenario("plane")));
  EXPECT_NE(message(definition).find("a second scenario named \"plane\"; allowed: "), std::string::npos);
  definition = two_scenes();
  definition.overrides = {"seed=9007199254740991"};  // 2^53 - 1: two more is too many
  EXPECT_NE(message(definition).find("/seed: got 9007199254740991; allowed: at most "), std::string::npos);
  definition.overrides = {};
  definition.seeds = 1'000'000;
  EXPECT_NE(message(definition).find("= 4000000 runs; allowed: at most 1000000"), std::string::npos);
}

TEST_F(BatchPlanOf, RunsWritesTheSameFilesWhateverTheJobs) {
  const BatchPlan plan = plan_batch(two_scenes());
  const auto run = [&](const char* out, std::size_t jobs) {
    BatchOptions options;
    options.directory = directory_ / out;
    options.jobs = jobs;
    return run_batch(plan, options);
  };
  const BatchReport report = run("one", 1);
  run("four", 4);
  test::expect_same_files(directory_ / "one", directory_ / "four");
  const RunReport alone = run_scenario(scenario_of(plan, 10), directory_ / "alone", false);
  test::expect_same_files(directory_ / "one/springs/summation/seed_1", directory_ / "alone");
  EXPECT_EQ(report.runs[10].summary.metrics.state_hash, alone.summary.metrics.state_hash);
  EXPECT_NE(report.runs[9].summary.metrics.state_hash, alone.summary.metrics.state_hash) << "other springs";
}

}  // namespace
}  // namespace hapbench::run_batch_test
