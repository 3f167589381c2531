#include "scenarios/cases/run_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <set>
#include <stdexcept>
#include <thread>

#include "scenarios/format/metric_sections.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::run_sweep_test {
namespace {

namespace fs = std::filesystem;
using test::minimal_scenario;
using test::read_file;
using Numbers = std::vector<std::size_t>;

Cases grid(const std::vector<std::string>& vary, const ScenarioText& scene = {}, std::vector<std::string> sets = {}) {
  std::vector<Axis> axes;
  for (const std::string& text : vary) axes.push_back(parse_axis(text));
  return {{scene}, std::move(sets), std::move(axes)};
}

SweepPlan plan_of(const Json& scenario, const std::vector<std::string>& vary,
                  const fs::path& file = test::data_directory() / "sweep.json") {
  return plan_sweep(grid(vary, {file, scenario}), {2, ""});
}

TEST(RunsToCheck, AreAllOfAFewAndTheEdgesOfMany) {
  EXPECT_EQ(runs_to_check(grid({"a=1,2,3", "b=1,2"})), (Numbers{0, 1, 2, 3, 4, 5}));
  const Cases many = grid({"a=1:100:100", "b=1:100:100", "c=x,y,z"});
  const Numbers checked = runs_to_check(many);
  EXPECT_TRUE(std::is_sorted(checked.begin(), checked.end()));
  EXPECT_LE(checked.size(), 2u * (100 + 100 + 3));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::set<std::size_t> seen;
    for (const std::size_t run : checked) seen.insert(many.place(run, axis));
    EXPECT_EQ(seen.size(), many.axes()[axis].size());
  }
  EXPECT_EQ(runs_to_check(grid({"a=1:1e6:1000000"})).size(), kMostChecked);
}

TEST(SweepPlan, GivesEachWarningOnceInTheOrderOfRuns) {
  // An algorithm that fixes its depth model overrides the one given.
  Json scenario = minimal_scenario("plane");
  scenario["rendering"] = {{"algorithm", "normal_projection"}, {"depth_model", "shortest_distance"}};
  const LoadedScenario loaded = load_scenario(ScenarioText{"sweep.json", scenario}, {});
  const std::vector<std::string> alone = with_files(loaded, loaded.warnings);
  ASSERT_FALSE(alone.empty());
  const SweepPlan plan = plan_of(scenario, {"time.steps=1:50:50"}, "sweep.json");
  EXPECT_EQ(plan.warnings, alone);
}

TEST(SweepPlan, HasExactlyTheMetricsOfItsRuns) {
  std::vector<test::NamedScenario> scenarios = test::rich_scenarios();
  for (test::NamedScenario& minimal : test::minimal_scenarios()) scenarios.push_back(std::move(minimal));
  Json prescribed = minimal_scenario("plane");
  prescribed["motion"]["position"] = {{"type", "prescribed"}, {"x_m", 0}, {"y_m", 0}, {"z_m", 0}};
  prescribed["reference_force"] = {{"z_N", 1.0}};
  scenarios.push_back({"with_reference_force", prescribed});
  Json block = minimal_scenario("block_with_hole");
  block["record"] = {{"ideal_trajectory", true}};
  scenarios.push_back({"with_ideal_trajectory", block});
  std::set<std::string> all;
  for (const auto& [name, json] : scenarios) {
    const bool has_targets = json.contains("hand") && json["hand"]["type"] == "tracking";  // which take their time
    const SweepPlan plan = plan_of(json, {has_targets ? "seed=1" : "time.steps=2"});
    std::vector<std::string> names;
    for (const Metric& metric : run_scenario(plan.cases.load(0), std::nullopt, false).metrics)
      names.push_back(metric.name);
    EXPECT_EQ(plan.metrics, names) << name;
    for (const std::string& bounded : plan.bounded)
      EXPECT_NE(std::find(names.begin(), names.end(), bounded), names.end()) << bounded;
    all.insert(names.begin(), names.end());
  }
  for (const Metric& metric : all_metrics()) EXPECT_TRUE(all.contains(metric.name)) << metric.name;
}

TEST(SweepPlan, HasAnotherDefinitionForEveryOtherContent) {
  const Json plane = minimal_scenario("plane");
  Json other = plane;
  other["seed"] = 5;
  std::set<std::string> definitions;
  for (const auto& vary : {std::vector<std::string>{"time.steps=1,2"},
                           {"time.steps=2,1"},
                           {"time.steps=1,2,3"},
                           {"time.steps=1,2", "seed=1"},
                           {"seed=1", "time.steps=1,2"}}) {
    definitions.insert(plan_of(plane, vary).definition);
  }
  definitions.insert(plan_of(other, {"time.steps=1,2"}).definition);
  const std::vector<std::string> steps = {"time.steps=1,2"};
  definitions.insert(plan_sweep(grid(steps, {"sweep.json", plane}, {"seed=5"}), {}).definition);
  const std::vector<Axis> box = {parse_axis("seed=1,2,3", true)};
  for (const Sampling& sampling :
       {Sampling{SamplingMethod::latin_hypercube, 3, 1}, Sampling{SamplingMethod::latin_hypercube, 3, 2},
        Sampling{SamplingMethod::latin_hypercube, 4, 1}, Sampling{SamplingMethod::random, 3, 1}}) {
    definitions.insert(plan_sweep(Cases({{"sweep.json", plane}}, {}, box, sampling), {}).definition);
  }
  EXPECT_EQ(definitions.size(), 11u);
  // Threads, the file's place and spelling do not count.
  EXPECT_EQ(plan_sweep(grid(steps, {"elsewhere.json", plane}), {7, ""}).definition,
            plan_of(plane, {"time.steps=1.0,2e0"}).definition);
}

TEST(SweepPlan, DefinesNamedFilesByTheirContents) {
  const test::TemporaryDirectory directory;
  const std::string points = test::read_file(test::data_directory() / "shell.csv");
  const auto definition = [&](const std::string& contents) {
    test::write_plainly(directory / "shell.csv", contents);
    return plan_of(minimal_scenario("point_shell"), {"time.steps=1,2"}, directory / "sweep.json").definition;
  };
  const std::string first = definition(points);
  EXPECT_EQ(definition(points), first);
  EXPECT_NE(definition(points.substr(0, points.rfind('\n', points.size() - 2) + 1)), first);
}

TEST(SweepPlan, RefusesBadMeshesOfToolsBeforeTheFirstRun) {
  const test::TemporaryDirectory directory;
  const std::string cube = test::read_file(test::data_directory() / "cube.obj");
  test::write_plainly(directory / "tool.obj", cube);
  test::write_plainly(directory / "open.obj", cube.substr(0, cube.rfind('f')));
  Json scene = minimal_scenario("plane");
  scene["tool"] = {{"type", "mesh"}, {"file", "tool.obj"}, {"scale", 0.001}, {"grid_m", 0.0002}};
  const auto error =
      test::input_error_of([&] { plan_of(scene, {"tool.file=tool.obj,open.obj"}, directory / "sweep.json"); });
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("sweep.json: /tool/file: "), std::string::npos) << error->what();
  EXPECT_NE(std::string(error->what()).find("open.obj"), std::string::npos) << error->what();
}

TEST(RunSweep, HasErrorRowsForRunsThatNobodyChecked) {
  const test::TemporaryDirectory directory;
  // So many values are not all checked before the first run; 4567 is one that is not.
  std::string seeds = "seed=0";
  for (int i = 1; i < 6000; ++i) seeds += "," + std::to_string(i == 4567 ? -1 : i);
  const SweepPlan plan = plan_of(minimal_scenario("springs"), {seeds});
  const SweepOptions options{.directory = directory.path(), .jobs = {3, ""}};
  const SweepReport report = run_sweep(plan, options);
  ASSERT_TRUE(report.failed);
  EXPECT_EQ(report.failed->run, 4567u);
  EXPECT_NE(report.failed->problem.find("/seed: got -1"), std::string::npos) << report.failed->problem;
  const SweepTable table = read_sweep(options.table());
  EXPECT_EQ(table.columns, plan.columns());
  EXPECT_EQ(table.counts.failed, 1u);
  SweepRow row = {"4567", "-1", "error", "false"};
  row.resize(plan.columns().size());
  EXPECT_EQ(table.rows[4567], row);
  EXPECT_EQ(table.outcome(table.rows[4568]), "completes");
}

TEST(ForEachJob, BeginsEachOnceInOrderAndNoMoreThanItsThreads) {
  for (const unsigned threads : {1u, 2u, 7u}) {
    std::atomic<std::size_t> ended = 0;
    for_each_job(400, {threads, ""}, [&](std::size_t i) {
      // All before this one have begun, and all of them but threads - 1 have ended.
      EXPECT_LT(i, ended + threads);
      std::this_thread::yield();
      ++ended;
    });
    EXPECT_EQ(ended, 400u);
  }
}

TEST(ForEachJob, ThrowsWhatTheLowestFailingJobThrew) {
  // All fail: the first one is begun before any other and is the lowest.
  for (const unsigned threads : {1u, 4u})
    EXPECT_THROW(for_each_job(50, {threads, ""},
                              [](std::size_t i) {
                                if (i == 0) throw std::domain_error("first");
                                throw std::runtime_error("later");
                              }),
                 std::domain_error);
}

}  // namespace
}  // namespace hapbench::run_sweep_test
