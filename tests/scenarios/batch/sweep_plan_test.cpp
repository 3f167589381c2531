#include "scenarios/batch/sweep_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/batch/sweeps.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::sweep_plan_test {
namespace {

using test::minimal_scenario;
using test::plan_of;
using Numbers = std::vector<std::size_t>;

SweepPoints grid(const std::vector<std::string>& vary) {
  std::vector<Axis> axes;
  for (const std::string& text : vary) axes.push_back(parse_axis(text));
  return SweepPoints(axes);
}

TEST(RunsToCheck, AreAllOfAFewAndTheEdgesOfMany) {
  EXPECT_EQ(runs_to_check(grid({"a=1,2,3", "b=1,2"})), (Numbers{0, 1, 2, 3, 4, 5}));
  const SweepPoints many = grid({"a=1:100:100", "b=1:100:100", "c=x,y,z"});
  const Numbers checked = runs_to_check(many);
  EXPECT_TRUE(std::is_sorted(checked.begin(), checked.end()));
  EXPECT_LE(checked.size(), 2u * (100 + 100 + 3));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::set<std::size_t> seen;
    for (const std::size_t run : checked) seen.insert(many.place(run, axis));
    EXPECT_EQ(seen.size(), many.axes()[axis].size());
  }
}

TEST(RunsToCheck, OfAMillionAreFew) {
  const Numbers checked = runs_to_check(grid({"a=1:1e6:1000000"}));
  EXPECT_EQ(checked.size(), kMostChecked);
  EXPECT_EQ(checked.front(), 0u);
  EXPECT_EQ(checked.back(), 999'999u);
  const SweepPoints sample({parse_sampled_axis("a=1:2")}, {SamplingMethod::sobol, 1'000'000, 1});
  EXPECT_EQ(runs_to_check(sample).size(), kMostChecked);
}

TEST(SweepPlan, OfALongRangeDescribesItByItsEnds) {
  const auto content = [](const char* vary) { return plan_of(minimal_scenario("plane"), {vary}).content["vary"][0]; };
  EXPECT_EQ(content("seed=1:3:3"), (Json{{"path", "seed"}, {"values", {"1", "2", "3"}}}));
  EXPECT_EQ(content("seed=1:20000:20000"),
            (Json{{"path", "seed"}, {"range", {1.0, 20000.0}}, {"scale", "linear"}, {"count", 20000}}));
}

TEST(SweepPlan, LoadsTheScenarioOfEachRun) {
  const SweepPlan plan = plan_of(minimal_scenario("plane"), {"time.steps=1,2", "rendering.algorithm=mean,summation"});
  const LoadedScenario loaded = scenario_of(plan, 2);
  EXPECT_EQ(loaded.scenario.time.steps, 2);
  EXPECT_EQ(loaded.scenario.rendering.algorithm, "mean");
}

TEST(SweepPlan, RefusesTheLowestBadRunWhateverTheThreads) {
  std::string list = "time.steps=";
  for (int i = 1; i <= 200; ++i) list += std::to_string(i < 120 ? i : -i) + ",";
  list += "0";
  for (int repeat = 0; repeat < 20; ++repeat) {
    const auto error = test::input_error_of([&] { plan_of(minimal_scenario("plane"), {list}); });
    ASSERT_TRUE(error);
    EXPECT_NE(std::string(error->what()).find("sweep.json: /time/steps: got -120; allowed: "), std::string::npos)
        << error->what();
  }
}

TEST(SweepPlan, GivesEachWarningOnceInTheOrderOfRuns) {
  // An algorithm that fixes its depth model overrides the one given.
  Json scenario = minimal_scenario("plane");
  scenario["rendering"] = {{"algorithm", "normal_projection"}, {"depth_model", "shortest_distance"}};
  const std::vector<std::string> alone = load_scenario(ScenarioText{"sweep.json", scenario}, {}).warnings;
  ASSERT_FALSE(alone.empty());
  const SweepPlan plan = plan_of(scenario, {"time.steps=1:50:50"}, "sweep.json");
  EXPECT_EQ(plan.warnings, alone);
}

TEST(SweepPlan, HasTheColumnsOfWhateverSomeRunRecords) {
  const auto header = [](const std::vector<std::string>& vary) {
    return sweep_header(plan_of(minimal_scenario("plane"), vary));
  };
  EXPECT_EQ(header({"record.energy=false"}).find("energy."), std::string::npos);
  EXPECT_NE(header({"record.energy=false,true"}).find(",energy.created_sum_J,"), std::string::npos);
  EXPECT_EQ(header({"record.energy=false,true"}), header({"record.energy=true,false"}));
  EXPECT_EQ(header({"record.energy=false,true"}).find("ideal_trajectory"), std::string::npos);
}

TEST(SweepPlan, HasExactlyTheMetricsOfItsRuns) {
  std::vector<test::NamedScenario> scenarios = test::rich_scenarios();
  for (test::NamedScenario& minimal : test::minimal_scenarios()) scenarios.push_back(std::move(minimal));
  Json prescribed = minimal_scenario("plane");
  prescribed["motion"]["position"] = {{"type", "prescribed"}, {"x_m", 0}, {"y_m", 0}, {"z_m", 0}};
  prescribed["reference_force"] = {{"z_N", 1.0}};
  prescribed["perception"] = Json::object();
  scenarios.push_back({"with_reference_force", prescribed});
  Json block = minimal_scenario("block_with_hole");
  block["record"] = {{"ideal_trajectory", true}};
  scenarios.push_back({"with_ideal_trajectory", block});
  std::set<std::string> all;
  for (const auto& [name, json] : scenarios) {
    const bool has_targets = json.contains("hand") && json["hand"]["type"] == "tracking";  // which take their time
    const SweepPlan plan = plan_of(json, {has_targets ? "seed=1" : "time.steps=2"});
    std::vector<std::string> names;
    for (const Metric& metric : metric_list(run_scenario(scenario_of(plan, 0), std::nullopt, false).summary))
      names.push_back(metric.name);
    EXPECT_EQ(plan.metrics, names) << name;
    all.insert(names.begin(), names.end());
  }
  for (const std::string& name : metric_names()) EXPECT_TRUE(all.contains(name)) << name;
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
  const SweepPoints grid({parse_axis("time.steps=1,2")});
  definitions.insert(plan_sweep({"sweep.json", plane}, {"seed=5"}, grid, 1, false).definition);
  const std::vector<Axis> box = {parse_sampled_axis("seed=1,2,3")};
  for (const Sampling& sampling :
       {Sampling{SamplingMethod::latin_hypercube, 3, 1}, Sampling{SamplingMethod::latin_hypercube, 3, 2},
        Sampling{SamplingMethod::latin_hypercube, 4, 1}, Sampling{SamplingMethod::random, 3, 1}}) {
    definitions.insert(plan_sweep({"sweep.json", plane}, {}, SweepPoints(box, sampling), 1, false).definition);
  }
  EXPECT_EQ(definitions.size(), 11u);
  // Threads, the file's place and spelling do not count.
  EXPECT_EQ(plan_sweep({"elsewhere.json", plane}, {}, grid, 7, false).definition,
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

/// A plane, which names no file, under a tool that is a mesh.
Json plane_under_mesh_tool() {
  Json scenario = minimal_scenario("plane");
  scenario["tool"] = {{"type", "mesh"}, {"file", "tool.obj"}, {"scale", 0.001}, {"grid_m", 0.0002}};
  return scenario;
}

TEST(SweepPlan, DefinesAToolByItsMesh) {
  const test::TemporaryDirectory directory;
  const auto definition = [&](const std::string& contents) {
    test::write_plainly(directory / "tool.obj", contents);
    return plan_of(plane_under_mesh_tool(), {"time.steps=1,2"}, directory / "sweep.json").definition;
  };
  const std::string cube = test::read_file(test::data_directory() / "cube.obj");
  const std::string first = definition(cube);
  EXPECT_EQ(definition(cube), first);
  EXPECT_NE(definition(cube + "# more\n"), first);
}

TEST(SweepPlan, RefusesBadMeshesOfToolsBeforeTheFirstRun) {
  const test::TemporaryDirectory directory;
  const std::string cube = test::read_file(test::data_directory() / "cube.obj");
  test::write_plainly(directory / "tool.obj", cube);
  test::write_plainly(directory / "open.obj", cube.substr(0, cube.rfind('f')));
  for (const std::string bad : {"missing.obj", "open.obj"}) {
    const auto error = test::input_error_of(
        [&] { plan_of(plane_under_mesh_tool(), {"tool.file=tool.obj," + bad}, directory / "sweep.json"); });
    ASSERT_TRUE(error) << bad;
    EXPECT_NE(std::string(error->what()).find("sweep.json: /tool/file: "), std::string::npos) << error->what();
    EXPECT_NE(std::string(error->what()).find(bad), std::string::npos) << error->what();
  }
}

TEST(SweepPlan, RefusesBadNamedFilesOfAnyRun) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "shell.csv", test::read_file(test::data_directory() / "shell.csv"));
  const auto error = test::input_error_of([&] {
    plan_of(minimal_scenario("point_shell"), {"environment.file=shell.csv,missing.csv"}, directory / "sweep.json");
  });
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("missing.csv"), std::string::npos) << error->what();
}

}  // namespace
}  // namespace hapbench::sweep_plan_test
