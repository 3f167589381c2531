#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::trials_test {
namespace {

namespace fs = std::filesystem;
using test::TemporaryDirectory;

/// Two subjects, two trials of two targets each, on a plane: quick.
LoadedScenario study(const char* record = R"({"trajectory": false})") {
  const Json json = Json::parse(std::string(R"({
    "name": "study", "time": {"step_s": 0.001, "duration_s": 30}, "environment": {"type": "plane", "size_m": 0.004},
    "hand": {"type": "tracking", "subjects": [{}, {"press_N": 1.5}], "trials": 2,
             "task": {"places_m": [[0.0005, 0, 0], [-0.0005, 0, 0]], "targets_per_place": 1}},
    "device": {"type": "admittance", "sensor": {"noise_N": 0.01}},
    "record": )") + record + "}");
  return read_scenario(json, ".");
}

TEST(Trials, EverySubjectDoesEveryTrialOnce) {
  const RunReport report = run_scenario(study(), std::nullopt, false);
  ASSERT_EQ(report.targets.size(), 8u);
  std::set<std::pair<std::size_t, std::size_t>> trials;
  for (const TargetRow& row : report.targets) trials.insert({row.subject, row.trial});
  EXPECT_EQ(trials, (std::set<std::pair<std::size_t, std::size_t>>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
  const std::vector<PlaceMetrics> places = place_metrics(report.targets);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0].success_rate.subjects, 2u);
  EXPECT_EQ(report.summary.result.outcome, Outcome::completes);
}

TEST(Trials, EveryStepOfEveryTrialIsTimed) {
  const RunReport report = run_scenario(study(R"({"trajectory": false, "timing": true})"), std::nullopt, false);
  ASSERT_TRUE(report.timing.latency);
  EXPECT_EQ(report.timing.latency->steps, report.summary.result.rows);
  EXPECT_FALSE(run_scenario(study(), std::nullopt, false).timing.latency);
}

TEST(Trials, TrialsDifferAndAnotherRunRepeatsThem) {
  const RunReport first = run_scenario(study(), std::nullopt, false),
                  again = run_scenario(study(), std::nullopt, false);
  EXPECT_EQ(first.summary.metrics.state_hash, again.summary.metrics.state_hash);
  std::set<double> forces;
  for (const TargetRow& row : first.targets) forces.insert(row.model_force);
  EXPECT_EQ(forces.size(), first.targets.size()) << "no two targets were met alike";
}

TEST(Trials, AStepAllocatesNothing) {
  EXPECT_EQ(
      run_scenario(study(R"({"trajectory": false, "energy": true})"), std::nullopt, false).summary.work.allocations,
      0u);
}

TEST(Trials, RecordsOfSeveralTrialsLieInDirectoriesOfTheirOwn) {
  const TemporaryDirectory dir;
  run_scenario(study(R"({"trajectory": true, "energy": true})"), dir / "out", false);
  for (const char* trial : {"subject_0_trial_0", "subject_0_trial_1", "subject_1_trial_0", "subject_1_trial_1"}) {
    EXPECT_TRUE(fs::exists(dir / "out" / trial / "trajectory.csv")) << trial;
    EXPECT_TRUE(fs::exists(dir / "out" / trial / "energy.csv")) << trial;
  }
  EXPECT_TRUE(fs::exists(dir / "out" / "targets.csv"));
  EXPECT_FALSE(fs::exists(dir / "out" / "trajectory.csv"));
  EXPECT_EQ(test::lines_of(test::read_file(dir / "out" / "targets.csv")).size(), 9u);

  run_scenario(study(), dir / "out", false);
  EXPECT_FALSE(fs::exists(dir / "out" / "subject_0_trial_0")) << "of the earlier run";
  EXPECT_TRUE(fs::exists(dir / "out" / "targets.csv"));
}

}  // namespace
}  // namespace hapbench::trials_test
