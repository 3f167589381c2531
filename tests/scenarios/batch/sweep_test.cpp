#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <set>

#include "scenarios/batch/join_shards.hpp"
#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/batch/sweep_columns.hpp"
#include "scenarios/batch/sweep_plan.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "sim/core/random.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::sweep_test {
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

TEST(RunsToCheck, AreAllOfAFewAndTheExtremesOfMany) {
  EXPECT_EQ(runs_to_check(grid({"a=1,2,3", "b=1,2"})), (Numbers{0, 1, 2, 3, 4, 5}));
  const Cases many = grid({"a=1:100:100", "b=1:100:100", "c=x,y,z"});
  const Numbers checked = runs_to_check(many);
  EXPECT_TRUE(std::is_sorted(checked.begin(), checked.end()));
  EXPECT_LE(checked.size(), 2u * (100 + 100 + 3));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::set<std::size_t> seen;
    for (const std::size_t run : checked) seen.insert(many.value_index(run, axis));
    EXPECT_EQ(seen.size(), many.axes()[axis].size());
  }
  EXPECT_EQ(runs_to_check(grid({"a=1:1e6:1000000"})).size(), kMaxChecked);
}

TEST(SweepPlan, GivesEachWarningOnceInTheOrderOfRuns) {
  // An algorithm that fixes its depth model overrides the given depth model.
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
    // Run only a few steps, because a whole task takes a long time.
    const bool has_targets = json.contains("hand") && json["hand"]["type"] == "tracking";
    const SweepPlan plan = plan_of(json, {has_targets ? "seed=1" : "time.steps=2"});
    std::vector<std::string> names;
    for (const Metric& metric : run_scenario(checked(plan.cases.load(0)), std::nullopt, false).metrics)
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
  for (const Sampling& sampling : {Sampling{kLatinHypercube, 3, 1}, Sampling{kLatinHypercube, 3, 2},
                                   Sampling{kLatinHypercube, 4, 1}, Sampling{kRandomPoints, 3, 1}}) {
    definitions.insert(plan_sweep(Cases({{"sweep.json", plane}}, {}, box, sampling), {}).definition);
  }
  EXPECT_EQ(definitions.size(), 11u);
  // The number of threads, the path of the scenario file and the spelling of the numbers do not change the definition.
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

/// Checks that the error names the line of a value of --points that a field does not allow. It names no line for a
/// fault of the scenario.
TEST(SweepPlan, NamesTheLineOfAPointThatAFieldRefuses) {
  const test::TemporaryDirectory directory;
  const auto refusal_of = [&](const std::string& points, const Json& scene) {
    test::write_plainly(directory / "points.csv", points);
    const ScenarioText text{directory / "scene.json", scene};
    const auto error = test::input_error_of([&] {
      std::vector<Axis> axes;
      Sampling sampling = read_points(directory / "points.csv", axes);
      plan_sweep({{text}, {}, std::move(axes), std::move(sampling)}, {1, ""});
    });
    return error ? std::string(error->what()) : "";
  };
  Json scene = minimal_scenario("plane");
  const std::string negative = refusal_of("# points\nrendering.stiffness_N_per_m\n1000\n-1\n", scene);
  EXPECT_NE(negative.find("points.csv, line 4: "), std::string::npos) << negative;
  EXPECT_NE(negative.find("scene.json: /rendering/stiffness_N_per_m: got -1"), std::string::npos) << negative;
  const std::string unit = refusal_of("rendering.stiffness_N_per_m [N/m]\n1000\n", scene);
  EXPECT_NE(unit.find("points.csv, line 1: got \"[N/m]\"; allowed: paths without units"), std::string::npos) << unit;
  scene["time"]["step_s"] = -1;
  const std::string other = refusal_of("rendering.stiffness_N_per_m\n1000\n", scene);
  EXPECT_NE(other.find("scene.json: /time/step_s"), std::string::npos) << other;
  EXPECT_EQ(other.find("points.csv"), std::string::npos) << other;
}

TEST(RunSweep, HasErrorRowsForRunsThatNobodyChecked) {
  const test::TemporaryDirectory directory;
  // The sweep does not check all of these values before the first run; 4567 is the index of an invalid value that it
  // does not check.
  std::string seeds = "seed=0";
  for (int i = 1; i < 6000; ++i) seeds += "," + std::to_string(i == 4567 ? -1 : i);
  const SweepPlan plan = plan_of(minimal_scenario("springs"), {seeds});
  const SweepOptions options{.directory = directory.path(), .jobs = {3, ""}};
  const SweepReport report = run_sweep(plan, options);
  ASSERT_TRUE(report.failed);
  EXPECT_EQ(*report.failed, 4567u);
  EXPECT_NE(report.problem.find("/seed: got -1"), std::string::npos) << report.problem;
  const SweepTable table = read_sweep(options.table());
  EXPECT_EQ(table.columns, sweep_columns(plan));
  EXPECT_EQ(table.counts.failed, 1u);
  SweepRow row = {"4567", "-1", "error", "false"};
  row.resize(sweep_columns(plan).size());
  EXPECT_EQ(table.rows[4567], row);
  EXPECT_EQ(table.outcome(table.rows[4568]), "completes");
}

TEST(ReadSweep, RefusesATableThatWasCutOrEdited) {
  const test::TemporaryDirectory directory;
  const SweepOptions options{.directory = directory.path()};
  run_sweep(plan_of(minimal_scenario("springs"), {"rendering.stiffness_N_per_m=1000,1500,2000"}), options);
  const std::vector<std::string> lines = test::lines_of(read_file(options.table()));
  ASSERT_EQ(lines.size(), 4u);
  /// Writes a table of these lines. Returns the error of read_sweep() after the name of the file, or its warning.
  const auto problem_of = [&](const std::vector<std::string>& table, const std::string& end = "\n") {
    std::string text;
    for (const std::string& line : table) text += (text.empty() ? "" : "\n") + line;
    test::write_plainly(options.table(), text + end);
    std::string problem;
    try {
      problem = read_sweep(options.table()).warning;
    } catch (const InputError& error) {
      problem = error.what();
    }
    return problem.empty() ? "" : problem.substr(options.table().string().size());
  };
  const auto with = [&lines](std::string from, const std::string& to) {
    std::vector<std::string> table = lines;
    table[2].replace(table[2].find(from), from.size(), to);
    return table;
  };
  const std::string edited = " (the file was edited)";
  EXPECT_EQ(problem_of(lines), "");
  EXPECT_EQ(problem_of({lines[0], lines[1], lines[3]}),
            ": 2 of 3 rows; the first missing row is of run 1; the file was cut or edited");
  EXPECT_EQ(problem_of({lines[0], lines[1], lines[1], lines[2], lines[3]}),
            ", line 3: got run 0 after run 0; allowed: each run once, sorted");
  EXPECT_EQ(problem_of(lines, ""),
            ", line 4: the line has no line end, so that its last cell may be cut off; allowed: complete lines");
  EXPECT_EQ(problem_of(with(",1500,", ",9999,")),
            ", line 3: rendering.stiffness_N_per_m: got \"9999\"; allowed: a value of the sweep" + edited);
  EXPECT_EQ(problem_of(with(",completes,", ",exploded,")),
            ", line 3: outcome: got \"exploded\"; allowed: an outcome" + edited);
  EXPECT_EQ(problem_of(with(",true,", ",yes,")), ", line 3: expected: got \"yes\"; allowed: true or false" + edited);
  EXPECT_EQ(problem_of(with(",true,", ",true,hello")).find(", line 3: steps: got \"hello"), 0u);
}

TEST(ReadSweep, FindsFieldsWithoutEffect) {
  const test::TemporaryDirectory directory;
  const SweepOptions options{.directory = directory.path()};
  Json scene = read_scenario_text(find_scenario("springs_oscillation")).json;
  scene["rendering"]["damping_N_s_per_m"] = 5;
  const std::vector<std::string> varied = {"rendering.stiffness_N_per_m=1000,2000", "rendering.damping_ratio=0,1"};
  run_sweep(plan_of(scene, varied), options);
  EXPECT_EQ(fields_without_effect(read_sweep(options.table())), std::vector<std::string>{"rendering.damping_ratio"});
  scene["rendering"].erase("damping_N_s_per_m");
  run_sweep(plan_of(scene, varied), options);
  EXPECT_TRUE(fields_without_effect(read_sweep(options.table())).empty());
  // Without a second run with the same values of the other fields, nothing is compared.
  run_sweep(plan_of(scene, {"rendering.stiffness_N_per_m=1000"}), options);
  EXPECT_TRUE(fields_without_effect(read_sweep(options.table())).empty());
}

// Tests the guarantees of a sweep: the bytes of its table, its memory, and its cost, also after interruptions.

/// Thrown to end a sweep as if its process were killed: all written bytes remain.
struct Killed {};

class SweepPromises : public testing::Test {
 protected:
  /// Runs a sweep that is interrupted after some rows: killed, stopped by a signal, or killed within a line.
  void interrupt(const SweepPlan& plan, SweepOptions options) {
    const std::uint64_t kind_of_end = random_.below(3);
    std::uint64_t rows = random_.below(plan.cases.size());
    options.added = [&rows, kind_of_end] {
      if (rows-- != 0) return;
      if (kind_of_end == 0) throw Killed();
      stop_work(SIGTERM);
    };
    try {
      run_sweep(plan, options);
    } catch (const Killed&) {
    } catch (const Stopped&) {
    }
    stop_work(0);
    const fs::path file = options.table().string() + ".part";
    if (kind_of_end != 2 || !fs::exists(file)) return;
    std::string text = read_file(file);
    test::write_plainly(file, text.substr(0, text.size() - std::min<std::size_t>(random_.below(9), text.size())));
  }
  void run_part(const SweepPlan& plan, const fs::path& directory, const std::optional<Shard>& shard) {
    SweepOptions options{.directory = directory, .shard = shard, .resume = true};
    for (std::uint64_t times = random_.below(4); times-- > 0;) {
      options.jobs.threads = 1 + static_cast<unsigned>(random_.below(4));
      interrupt(plan, options);
    }
    run_sweep(plan, options);
  }

  test::TemporaryDirectory directory_;
  Random random_{20261124};
};

TEST_F(SweepPromises, TheSameBytesWhateverTheJobsTheShardsAndTheKills) {
  // The environment is not the axis that varies slowest, so the runs are not made in the order of the table.
  const SweepPlan plan =
      plan_of(test::minimal_scenario("plane"),
              {"time.steps=1:6:6", "environment.spacing_m=5e-4,4e-4", "rendering.algorithm=mean,summation,proxy"},
              directory_ / "scene.json");
  const fs::path whole = directory_ / "whole";
  fs::create_directory(whole);
  ASSERT_FALSE(run_sweep(plan, {.directory = whole}).failed);
  ASSERT_EQ(test::lines_of(read_file(whole / "sweep.csv")).size(), 37u);
  for (int attempt = 0; attempt < 40; ++attempt) {
    const fs::path out = directory_ / "out";
    fs::create_directory(out);
    const std::size_t shards = random_.below(5);
    for (std::size_t i = 0; i < shards; ++i) run_part(plan, out, Shard{i, shards});
    if (shards == 0) run_part(plan, out, std::nullopt);
    EXPECT_EQ(join_shards(out), shards > 0);
    for (const char* file : {"sweep.csv", "sweep.json"})
      ASSERT_EQ(read_file(out / file), read_file(whole / file)) << "attempt " << attempt << ", " << shards << " shards";
    fs::remove_all(out);
  }
}

TEST_F(SweepPromises, AFailedRunIsTriedAgain) {
  const fs::path shell = directory_ / "shell.csv", out = directory_ / "out", whole = directory_ / "whole";
  const auto restore = [&] { test::write_plainly(shell, read_file(test::data_directory() / "shell.csv")); };
  restore();
  const SweepPlan plan = plan_of(test::minimal_scenario("point_shell"),
                                 {"environment.file=shell.csv", "time.steps=1,2,3"}, directory_ / "scene.json");
  for (const fs::path& folder : {out, whole}) fs::create_directory(folder);
  run_sweep(plan, {.directory = whole});
  fs::remove(shell);
  SweepOptions options{.directory = out};
  run_sweep(plan, options);
  EXPECT_EQ(read_sweep(options.table()).counts.failed, 3u);
  restore();
  options.resume = true;
  EXPECT_FALSE(run_sweep(plan, options).failed);
  EXPECT_EQ(read_file(out / "sweep.csv"), read_file(whole / "sweep.csv"));
}

/// Fixture of tests that take seconds.
class SlowSweepPromises : public SweepPromises {};

double most_resident_bytes() {
  ::rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

TEST_F(SlowSweepPromises, TheMemoryOfAThousandRunsForAHundredTimesAsMany) {
  const auto run = [&](const char* seeds) {
    const SweepPlan plan = plan_of(test::minimal_scenario("springs"), {seeds}, "springs.json");
    run_sweep(plan, {.directory = directory_.path(), .jobs = {2, ""}});
    return most_resident_bytes();
  };
  const double few = run("seed=1:1000:1000");
  // The positions of the rows in their file take 8 bytes per run, 0.8 MB. The memory that the allocator keeps varies.
  EXPECT_LT(run("seed=1:100000:100000") - few, 4e6);
}

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Returns the processor time [s] of the runs of a plan over three grids without a sweep: every simulation, plus the
/// construction of one shell for each grid.
double seconds_without_sweep(const SweepPlan& plan) {
  double simulations = 0.0, shells = 0.0;
  for (std::size_t run = 0; run < plan.cases.size(); ++run) {
    const LoadedScenario loaded = plan.cases.load(run);
    const double start = processor_seconds();
    const auto shell = make_shell(loaded.scenario, loaded.files);
    const double before = processor_seconds();
    shells += before - start;
    run_with_shell(checked(loaded), shell);
    simulations += processor_seconds() - before;
  }
  return simulations + shells * 3.0 / static_cast<double>(plan.cases.size());
}

TEST_F(SlowSweepPromises, LittleMoreTimeThanTheSimulationsInWhicheverOrderTheAxesAreGiven) {
  const Json scene = test::minimal_scenario("block_with_hole");
  const std::vector<std::string> vary[] = {{"environment.grid_m=2e-4,1.5e-4,1e-4", "time.steps=20000:20019:20"},
                                           {"time.steps=20000:20019:20", "environment.grid_m=2e-4,1.5e-4,1e-4"}};
  for (const auto& axes : vary) {
    const SweepPlan plan = plan_of(scene, axes, directory_ / "scene.json");
    // Other programs on the machine make every measurement longer, never shorter. So take the shortest of five
    // measurements.
    double sweep = 1e9, simulations = 1e9;
    for (int turn = 0; turn < 5; ++turn) {
      const double begun = processor_seconds();
      run_sweep(plan, {.directory = directory_.path()});
      sweep = std::min(sweep, processor_seconds() - begun);
      simulations = std::min(simulations, seconds_without_sweep(plan));
    }
    EXPECT_LT(sweep, 1.3 * simulations) << axes.front();
  }
}

}  // namespace
}  // namespace hapbench::sweep_test
