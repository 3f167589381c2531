#include "scenarios/run/run_scenario.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "scenarios/format/load_scenario.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/result_folder.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// A run with its trials, its files and its end: complete, diverged or stopped.
namespace hapbench::run_scenario_test {
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

TEST(Trials, EverySubjectDoesEveryTrialOnceAndDifferently) {
  const Result report = run_scenario(study(R"({"trajectory": false, "timing": true})"), std::nullopt, false);
  ASSERT_EQ(report.targets.size(), 8u);
  std::set<std::pair<std::size_t, std::size_t>> trials;
  std::set<double> forces;
  for (const TargetRow& row : report.targets) {
    trials.insert({row.subject, row.trial});
    forces.insert(row.model_force);
  }
  EXPECT_EQ(trials, (std::set<std::pair<std::size_t, std::size_t>>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
  EXPECT_EQ(forces.size(), 8u) << "no two targets were met alike";
  EXPECT_EQ(report.end.outcome, Outcome::completes);
  EXPECT_EQ(report.timing.latency->steps, report.end.rows);
  EXPECT_EQ(report.state_hash, run_scenario(study(), std::nullopt, false).state_hash) << "another run repeats them";
}

TEST(Trials, RecordsOfSeveralTrialsLieInDirectoriesOfTheirOwn) {
  const TemporaryDirectory dir;
  EXPECT_EQ(run_scenario(study(R"({"trajectory": true, "energy": true})"), dir / "out", false).work.allocations, 0u);
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

LoadedScenario springs(const char* record) {
  Json json = Json::parse(
      R"({"environment": {"type": "springs", "groups": [{"direction": [1, 2, 3], "count": 1}, {"direction": [1, 0, 0], "count": 2}]},
                              "initial": {"position_m": [0.001, 0.002, 0.0005]}})");
  json["time"] = {{"step_s", 0.0005}, {"steps", 2000}};
  json["record"] = Json::parse(record);
  return read_scenario(json, ".");
}

TEST(ExpectedOutput, IsWithinAFactorOfTwoOfWhatIsWritten) {
  for (const char* record :
       {R"({"trajectory": true, "every": 3})", R"({"trajectory": false, "energy": true, "stiffness_tensor": true})",
        R"({"trajectory": false, "ratio_iterations": [0, 1, 3]})"}) {
    const test::TemporaryDirectory directory;
    const LoadedScenario loaded = springs(record);
    run_scenario(loaded, directory.path(), false);
    double written = 0.0;
    for (const auto& entry : std::filesystem::directory_iterator(directory.path())) {
      if (entry.path().extension() == ".csv") written += static_cast<double>(entry.file_size());
    }
    const double expected = expected_output_bytes(loaded.scenario);
    EXPECT_LT(expected, 2.0 * written) << record;
    EXPECT_GT(expected, 0.5 * written) << record;
  }
}

/// A hand whose damping is too much for the time step drives the handle, which is a body of its own, to infinity, while
/// the tool swings on.
TEST(Divergence, OfTheHandleEndsTheRun) {
  const Json scenario = Json::parse(R"({
    "time": {"step_s": 0.003, "steps": 2000},
    "environment": {"type": "plane"},
    "initial": {"position_m": [0, 0, 0]},
    "device": {"type": "admittance"},
    "hand": {"type": "impedance", "stiffness_N_per_m": 500, "damping_N_s_per_m": 50,
             "target": {"x_m": 0, "y_m": 0, "z_m": -0.001}}
  })");
  const Result run = run_scenario(read_scenario(scenario, "."), std::nullopt, false);
  EXPECT_EQ(run.end.outcome, Outcome::diverges);
  const std::string quantity = run.end.divergence.quantity;
  EXPECT_TRUE(quantity == "handle position" || quantity == "handle velocity" || quantity == "measured force")
      << quantity;
  EXPECT_GT(run.end.divergence.magnitude, run.end.divergence.bound);
}

/// With SIGINT as a shell in the foreground leaves it; behind "&" it is ignored, and stays so.
class StopSignals : public testing::Test {
 protected:
  StopSignals() : before_(std::signal(SIGINT, SIG_DFL)) {}
  ~StopSignals() override { std::signal(SIGINT, before_); }

 private:
  void (*before_)(int);
};

TEST_F(StopSignals, EndARunOfWhichNothingIsLeft) {
  const test::TemporaryDirectory directory;
  LoadedScenario loaded = read_scenario(test::minimal_scenario("springs"), ".");
  for (const bool timed : {false, true}) {
    loaded.scenario.record.timing = timed;
    const StopSignal signals;
    std::raise(SIGINT);
    EXPECT_THROW(run_scenario(loaded, directory / "out/below", false), Stopped);
    EXPECT_EQ(directory.entries(), std::vector<std::string>{});
  }
  run_scenario(loaded, directory / "out/below", false);
  EXPECT_TRUE(std::filesystem::exists(directory / "out/below/summary.json"));
}

}  // namespace
}  // namespace hapbench::run_scenario_test
