#include <gtest/gtest.h>

#include <algorithm>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/meshes.hpp"

/// hapbench run: files, expectations, warnings, times.
namespace hapbench::run_test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;

class RunCommand : public testing::Test {
 protected:
  std::string write_scenario(const std::string& name, const Json& json) const {
    fs::create_directories((directory_.path() / name).parent_path());
    test::write_plainly(directory_.path() / name, json.dump());
    return (directory_.path() / name).string();
  }
  std::string out(const std::string& name = "out") const { return (directory_ / name).string(); }
  Json summary(const std::string& directory = "out") const {
    return Json::parse(test::read_file(directory_.path() / directory / "summary.json"));
  }

  test::TemporaryDirectory directory_;
};

TEST_F(RunCommand, WritesOneScenarioIntoTheGivenDirectory) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out()});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(test::names_below(out()),
            (Names{"columns.json", "scenario.effective.json", "summary.json", "trajectory.csv"}));
}

TEST_F(RunCommand, WritesSeveralScenariosIntoADirectoryEach) {
  const std::string file = write_scenario("my scene.json", test::minimal_scenario("plane"));
  const ProgramRun run = hapbench({"run", "single_spring", file, "--out", out()});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(test::names_below(out()),
            (Names{"my scene/columns.json", "my scene/scenario.effective.json", "my scene/summary.json",
                   "my scene/trajectory.csv", "single_spring/columns.json", "single_spring/scenario.effective.json",
                   "single_spring/summary.json", "single_spring/trajectory.csv"}));
}

TEST_F(RunCommand, WritesBelowResultsOutWithoutAGivenDirectory) {
  test::ProgramOptions options;
  options.directory = directory_.path();
  EXPECT_EQ(hapbench({"run", "single_spring"}, options).status, 0);
  EXPECT_EQ(test::names_below(directory_ / "results/out/single_spring").size(), 4u);
}

TEST_F(RunCommand, WritesWhatTheScenarioRecords) {
  Json json = test::minimal_scenario("plane");
  json["record"] =
      Json::parse(R"({"trajectory": false, "contacts": true, "ratio_iterations": [0, 3], "stiffness_tensor": true,
                      "timing": true})");
  EXPECT_EQ(hapbench({"run", write_scenario("a.json", json), "--out", out()}).status, 0);
  EXPECT_EQ(test::names_below(out()),
            (Names{"columns.json", "contact_trace.csv", "contacts.csv", "ratios.csv", "scenario.effective.json",
                   "stiffness_tensor.csv", "summary.json", "timing.json"}));
  // Another run into the same directory leaves no file that is not its own.
  json["record"] = Json::object();
  EXPECT_EQ(hapbench({"run", write_scenario("a.json", json), "--out", out()}).status, 0);
  EXPECT_EQ(test::names_below(out()),
            (Names{"columns.json", "scenario.effective.json", "summary.json", "trajectory.csv"}));
}

TEST_F(RunCommand, RecordsEachNthRow) {
  Json json = test::minimal_scenario("springs");
  json["record"]["every"] = 7;
  EXPECT_EQ(hapbench({"run", write_scenario("a.json", json), "--out", out()}).status, 0);
  const auto rows = lines_of(test::read_file(directory_ / "out/trajectory.csv"));
  ASSERT_EQ(rows.size(), 4u);  // header, rows 0, 7, 14 of 20
  EXPECT_EQ(rows[3].substr(0, 3), "14,");
  EXPECT_EQ(summary()["steps"], 20);
}

TEST_F(RunCommand, ShowsATableRowForEachScenario) {
  const ProgramRun run = hapbench({"run", "single_spring", "single_damper", "--out", out()});
  const auto lines = lines_of(run.out);
  ASSERT_EQ(lines.size(), 11u) << run.out;
  for (const char* title : {"con", "land.", "mean", "step", ">30Hz", "rev.", "depth", "us/"}) {
    EXPECT_NE(lines[0].find(title), std::string::npos) << title;
  }
  for (const char* title : {"scenario", "algorithm", "outcome", "%", "max N", "p99 N", "rms N", "1/s", "mm", "ratio"}) {
    EXPECT_NE(lines[1].find(title), std::string::npos) << title;
  }
  EXPECT_EQ(lines[3].find("single_spring summation completes"), 0u) << lines[3];
  EXPECT_EQ(lines[4].find("single_damper summation completes"), 0u) << lines[4];
  EXPECT_EQ(lines[6].find("99 % of the steps take at most "), 0u) << lines[6];
  EXPECT_EQ(lines[8], "wrong with single_damper: damping (0.998)");
  EXPECT_EQ(lines[10], "results in " + out());
}

TEST_F(RunCommand, SaysThatItReplacesARunOfOtherFields) {
  const auto notes_of = [this](const char* steps) {
    return hapbench({"run", "single_spring", "--set", std::string("time.steps=") + steps},
                    {.directory = directory_.path()})
        .err;
  };
  EXPECT_EQ(notes_of("5"), "");
  EXPECT_EQ(notes_of("5"), "");
  EXPECT_EQ(notes_of("6"),
            "hapbench: replaces the run of other fields in results/out/single_spring; --out DIRECTORY keeps both\n");
}

TEST_F(RunCommand, PrintsNothingUnderQuiet) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out(), "--quiet"});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out + run.err, "");
}

TEST_F(RunCommand, PrintsTheSummariesUnderJson) {
  const ProgramRun run = hapbench({"run", "single_spring", "single_damper", "--out", out(), "--json"});
  const Json json = run.json();
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0], summary("out/single_spring"));
  EXPECT_EQ(json[1]["name"], "single_damper");
}

TEST_F(RunCommand, OverridesFieldsForEveryScenario) {
  const ProgramRun run = hapbench({"run", "single_spring", "single_damper", "--out", out(), "--set", "time.steps=5",
                                   "--set", "initial.position_m=[0.002, 0, 0]", "--json"});
  EXPECT_EQ(run.status, 0) << run.err;
  for (const Json& one : run.json()) EXPECT_EQ(one["steps"], 5);
  const auto rows = lines_of(test::read_file(directory_ / "out/single_damper/trajectory.csv"));
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(test::cells_of(rows[1])[2], "0.002");
}

TEST_F(RunCommand, TakesTheFilesNameForANamelessScenario) {
  hapbench({"run", write_scenario("nameless.json", test::minimal_scenario("plane")), "--out", out()});
  EXPECT_EQ(summary()["name"], "nameless");
}

TEST_F(RunCommand, FindsFilesBesideTheScenarioFromAnywhere) {
  write_scenario("deep/er/scene.json", test::minimal_scenario("point_shell"));
  fs::copy_file(test::data_directory() / "shell.csv", directory_ / "deep/er/shell.csv");
  test::ProgramOptions options;
  options.directory = directory_ / "deep";
  EXPECT_EQ(hapbench({"run", "er/scene.json", "--out", "../out"}, options).status, 0);
  EXPECT_TRUE(fs::exists(directory_ / "out/summary.json"));
}

TEST_F(RunCommand, RefusesTwoScenariosOfOneName) {
  const std::string a = write_scenario("a/x.json", test::minimal_scenario("plane"));
  const std::string b = write_scenario("b/x.json", test::minimal_scenario("plane"));
  const ProgramRun run = hapbench({"run", a, b, "--out", out()});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find(b + ": a second scenario named \"x\""), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(RunCommand, WarnsOnStandardErrorOfWhatTheAlgorithmOverrides) {
  Json json = test::minimal_scenario("plane");
  json["rendering"] = {{"algorithm", "original_averaging"}, {"depth_model", "surface_normal"}};
  const std::string file = write_scenario("a.json", json);
  const ProgramRun run = hapbench({"run", file, "--out", out()});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err,
            "hapbench: warning: " + file +
                ": /rendering/depth_model: \"surface_normal\" is not used: algorithm \"original_averaging\" is "
                "defined with \"shortest_distance\"\n");
}

TEST_F(RunCommand, ExitsWith3WhenARunDivergesUnexpectedlyAndKeepsWhatWasRecorded) {
  const ProgramRun run =
      hapbench({"run", "single_spring_unstable", "--out", out(), "--set", "expect.outcome=completes"});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.err.find("outcome is \"diverges\""), std::string::npos) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1);
  const Json s = summary();
  EXPECT_EQ(s["outcome"], "diverges");
  EXPECT_EQ(s["expected"], false);
  const Json& divergence = s["divergence"];
  const std::string quantity = divergence["quantity"];
  EXPECT_TRUE(quantity == "position" || quantity == "velocity" || quantity == "rendered force") << quantity;
  EXPECT_GT(divergence["magnitude"], divergence["bound"]);
  // All rows before the one that diverged are there.
  const std::size_t step = divergence["step"];
  const auto rows = lines_of(test::read_file(directory_ / "out/trajectory.csv"));
  EXPECT_EQ(rows.size(), 1 + step);
  EXPECT_EQ(s["steps"], step);
  EXPECT_EQ(test::cells_of(rows.back())[0], std::to_string(step - 1));
  EXPECT_NEAR(divergence["time_s"].get<double>(), 0.0005 * static_cast<double>(step), 1e-12);
}

TEST_F(RunCommand, ExitsWith0WhenADivergenceIsExpected) {
  const ProgramRun run = hapbench({"run", "single_spring_unstable", "--out", out()});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(summary()["expected"], true);
  EXPECT_EQ(summary()["outcome"], "diverges");
}

TEST_F(RunCommand, ExitsWith3WhenAnExpectedDivergenceFailsToCome) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out(), "--set", "expect.outcome=diverges"});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.err.find("outcome is \"completes\"; expected \"diverges\""), std::string::npos) << run.err;
}

TEST_F(RunCommand, GoesOnAfterAnUnexpectedOutcome) {
  const ProgramRun run =
      hapbench({"run", "single_spring", "single_damper", "--out", out(), "--set", "expect.outcome=diverges"});
  EXPECT_EQ(run.status, 3);
  EXPECT_TRUE(fs::exists(directory_ / "out/single_damper/summary.json"));
  EXPECT_EQ(lines_of(run.err).size(), 2u);
}

TEST_F(RunCommand, ExitsWith3AndNamesEachMetricOutOfItsBounds) {
  const ProgramRun run =
      hapbench({"run", "single_spring", "--out", out(), "--set", "expect.metrics.force_max_N.max=1", "--set",
                "expect.metrics.steps_in_contact.min=401", "--set", "expect.metrics.depth_max_m.max=0.5"});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.err.find("force_max_N is 20; expected at most 1"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("steps_in_contact is 400; expected at least 401"), std::string::npos) << run.err;
  EXPECT_EQ(lines_of(run.err).size(), 2u);
  EXPECT_EQ(summary()["expected"], false);
}

TEST_F(RunCommand, ExitsWith3WhenABoundedMetricHasNoValue) {
  // Nothing is touched, so there is no ratio.
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out(), "--set", "environment.groups=[]", "--set",
                                   "expect.metrics.ratio_max.max=2"});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.err.find("ratio_max has no value"), std::string::npos) << run.err;
}

TEST_F(RunCommand, StopsADivergenceOfTheFirstRow) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out(), "--set", "bounds.position_m=1e-9"});
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(summary()["divergence"]["step"], 0);
  EXPECT_EQ(summary()["metrics"]["final_position_m"], nullptr);
  EXPECT_EQ(lines_of(test::read_file(directory_ / "out/trajectory.csv")).size(), 1u);
}

TEST_F(RunCommand, WarnsOfFrictionThatTheIntegratorCannotStep) {
  const std::string shown = hapbench({"run", "peg_in_hole_2d_summation", "--out", out()}).err;
  EXPECT_NE(
      shown.find("warning: peg_in_hole_2d_summation: beyond 79.5 N of spring force, in 2 of 5 rows, first in step 0, "),
      std::string::npos)
      << shown;
  EXPECT_EQ(summary()["warnings"].size(), 1u);
  EXPECT_EQ(summary()["metrics"]["explicit_friction_limit_N"], 79.5);
  EXPECT_EQ(summary()["metrics"]["explicit_friction_first_step"], 0);
  const ProgramRun gentle = hapbench({"run", "peg_in_hole_2d_mean", "--out", out("gentle")});
  EXPECT_EQ(gentle.err, "");
  EXPECT_EQ(summary("gentle")["metrics"]["explicit_friction_rows_beyond"], 0);
}

TEST_F(RunCommand, WarnsOfAReductionThatMakesTheForceJump) {
  const std::string shown = hapbench({"run", "corner_shaped_stiffness", "--out", out()}).err;
  EXPECT_NE(shown.find("warning: corner_shaped_stiffness: reduction: kept points change in "), std::string::npos);
  EXPECT_NE(shown.find(" N elsewhere; rendering.reduction=null keeps them all\n"), std::string::npos) << shown;
  EXPECT_GT(summary()["metrics"]["reduction_changes"], 0);
  const ProgramRun all =
      hapbench({"run", "corner_shaped_stiffness", "--out", out("all"), "--set", "rendering.reduction=null"});
  EXPECT_EQ(all.err, "");
  EXPECT_TRUE(summary("all")["metrics"]["reduction_changes"].is_null());
}

TEST_F(RunCommand, TakesTheBeginningOfSettledContactFromTheScenario) {
  hapbench({"run", "single_spring", "--out", out()});
  const auto settled = [this](const char* run) { return summary(run)["metrics"]["settled_s"].get<double>(); };
  EXPECT_DOUBLE_EQ(settled("out"), 0.15) << "0.2 s in contact, of which 0.05 s are the landing";
  hapbench({"run", "single_spring", "--out", out("all"), "--set", "metrics.from_s=0"});
  EXPECT_DOUBLE_EQ(settled("all"), 0.2);
  EXPECT_TRUE(summary("all")["metrics"]["landing_force_max_N"].is_null());
  hapbench({"run", "single_spring", "--out", out("late"), "--set", "metrics.settling_s=0.125"});
  EXPECT_DOUBLE_EQ(settled("late"), 0.075);
}

/// A run that missed its object says so: outcome, warning, exit status.
class MissedRun : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  test::ProgramRun run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--out", path("out")});
    return hapbench(arguments);
  }
  Json summary() const { return Json::parse(test::read_file(directory_ / "out" / "summary.json")); }

  test::TemporaryDirectory directory_;
};

TEST_F(MissedRun, WithASlipOfUnitsAsksForTheScale) {
  const test::ProgramRun missed = run({"mesh_molar", "--set", "environment.scale=1e-6"});
  EXPECT_EQ(missed.status, 3);
  EXPECT_NE(missed.err.find("warning: mesh_molar: never in contact"), std::string::npos) << missed.err;
  EXPECT_NE(missed.err.find("is environment.scale right?"), std::string::npos) << missed.err;
  EXPECT_EQ(summary()["outcome"], "no_contact");
  EXPECT_EQ(summary()["metrics"]["contact_share"], 0.0);
  EXPECT_TRUE(summary()["metrics"]["last_contact_s"].is_null());
  EXPECT_EQ(summary()["warnings"].size(), 1u);
  EXPECT_EQ(summary()["diagnosis"][0]["rule"], "lost");
  EXPECT_NE(missed.out.find("(rule lost: 1 > 0.5)\n  try: environment.scale,"), std::string::npos) << missed.out;
}

TEST_F(MissedRun, IsExpectedWhereTheScenarioSaysSo) {
  EXPECT_EQ(run({"mesh_molar", "--set", "environment.scale=1e-6", "--set", "expect.outcome=no_contact"}).status, 0);
}

TEST_F(MissedRun, WhoseStrokeHasAnotherClockIsWarnedOfBeforeItRuns) {
  test::write_plainly(directory_ / "stroke.csv",
                      "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n10,0,0,0,0,0,-1\n10.5,0,0,-0.001,0,0,-1\n");
  const test::ProgramRun run = this->run(
      {"poke_plane", "--set", "motion={\"position\":{\"type\":\"file\",\"file\":\"" + path("stroke.csv") + "\"}}"});
  EXPECT_NE(run.err.find("the stroke's clock runs from 10 to 10.5 s"), std::string::npos) << run.err;
}

TEST_F(MissedRun, ExpectationsDoNotJudgeARunTheyWereNotWrittenFor) {
  // Ten times the stiffness is beyond the scenario's bound on the force.
  EXPECT_EQ(run({"single_spring", "--set", "rendering.stiffness_N_per_m=20"}).status, 0);
  EXPECT_EQ(run({"ten_minutes_in_contact", "--set", "record.energy=false", "--set", "time.steps=1000"}).status, 0);
  EXPECT_EQ(run({"single_spring", "--set", "expect.metrics.force_max_N.max=1e-9"}).status, 3);
}

TEST_F(MissedRun, ExpectationsOfTheIdealTrajectoryAreOverTheRecordedRows) {
  test::write_plainly(directory_ / "tenth.json", R"({
    "extends": "rotate_in_hole",
    "time": {"step_s": 0.0005, "steps": 50},
    "record": {"every": 5, "ideal_trajectory": true},
    "expect": {"outcome": "completes", "metrics": {"ideal_trajectory.gentle.rows": {"min": 10, "max": 10}}}})");
  EXPECT_EQ(run({path("tenth.json")}).status, 0);
  EXPECT_EQ(run({path("tenth.json"), "--set", "record.every=10"}).status, 0) << "half the rows: another run";
}

/// Every command that reads an odd mesh warns once and goes on.
class MeshWarnings : public testing::Test {
 protected:
  MeshWarnings() {
    TriangleSoup open = test::cube(5.0);
    open.triangles.pop_back();
    test::write_plainly(directory_ / "cube.obj", test::obj_text(open));
    Json scene = test::minimal_scenario("mesh");
    scene["initial"]["position_m"] = {-0.005, 0.005, 0.005};  // on a corner away from the hole
    scene["tool"]["diameter_m"] = 0.002;
    test::write_plainly(directory_ / "scene.json", scene.dump());
  }
  void expect_warning(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin() + 1, path("scene.json"));
    const test::ProgramRun run = hapbench(arguments);
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(
        run.err,
        "hapbench: warning: " + path("scene.json") +
            ": /environment/file: cube.obj: the mesh is open: 3 boundary edges, within x 5 ... 5, y -5 ... 0, z 0 ... 5 mm; beyond them "
            "there is nothing to touch\n")
        << arguments[0];
  }
  std::string path(const std::string& name) const { return (directory_ / name).string(); }

  test::TemporaryDirectory directory_;
};

TEST_F(MeshWarnings, ComeOnceFromEveryCommand) {
  expect_warning({"validate"});
  expect_warning({"run", "--out", path("out")});
  expect_warning({"run", "--quiet", "--out", path("out")});
  expect_warning({"shell", "--out", path("shell.csv")});
  expect_warning({"compare", "--algorithms", "mean,summation,shaped_stiffness", "--out", path("out")});
}

TEST_F(MeshWarnings, AreInTheSummaryWhereverTheFileLies) {
  expect_warning({"run", "--out", path("out")});
  const Json said = Json::parse(test::read_file(directory_ / "out" / "summary.json"))["warnings"];
  ASSERT_EQ(said.size(), 1u) << said;
  EXPECT_TRUE(said[0].get<std::string>().starts_with("/environment/file: cube.obj: the mesh is open: 3")) << said;
}

TEST_F(MeshWarnings, DoNotChangeWhatIsWritten) {
  expect_warning({"shell", "--out", path("first.csv")});
  expect_warning({"shell", "--out", path("again.csv")});
  const std::string text = test::read_file(directory_ / "first.csv");
  EXPECT_EQ(test::read_file(directory_ / "again.csv"), text);
  EXPECT_EQ(test::lines_of(text).size(), 1u + 8u);
}

/// `hapbench run --latency` and record.timing.
class Latency : public testing::Test {
 protected:
  std::string out(const std::string& name = "out") const { return (directory_ / name).string(); }
  Json json_file(const std::string& name) const { return Json::parse(test::read_file(directory_ / name)); }

  test::TemporaryDirectory directory_;
};

TEST_F(Latency, TimesEveryStepAndPrintsATable) {
  const ProgramRun run = hapbench({"run", "single_spring", "single_damper", "--out", out(), "--latency"});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto lines = lines_of(run.out);
  ASSERT_EQ(lines.size(), 16u) << run.out;
  for (const char* column : {"steps", "p50 us", "p95 us", "p99 us", "p99.9 us", "max us", "> 0.500 ms", "> 0.488 ms"}) {
    EXPECT_NE(lines[8].find(column), std::string::npos) << column;
  }
  EXPECT_EQ(lines[10].find("single_spring"), 0u);
  EXPECT_EQ(lines[11].find("single_damper"), 0u);
  const Json latency = json_file("out/single_spring/timing.json")["step_latency"];
  EXPECT_EQ(latency["steps"], json_file("out/single_spring/summary.json")["steps"]);
  EXPECT_LE(latency["p50_s"], latency["p95_s"]);
  EXPECT_LE(latency["p99_9_s"], latency["max_s"]);
  EXPECT_GT(latency["max_s"], 0.0);
  std::uint64_t binned = 0;
  for (const Json& bin : latency["histogram"]) binned += bin["steps"].get<std::uint64_t>();
  EXPECT_EQ(binned, latency["steps"]);
}

// Each step of a bin takes at least the bin's lower end.
TEST_F(Latency, StepsTakeNoLongerThanTheLoop) {
  hapbench({"run", "drill_in_hole", "--out", out(), "--latency"});
  const Json timing = json_file("out/timing.json");
  double least = 0.0;
  for (const Json& bin : timing["step_latency"]["histogram"]) {
    least += bin["from_s"].get<double>() * bin["steps"].get<double>();
  }
  EXPECT_LE(least, timing["loop_s"]);
  EXPECT_LE(timing["step_latency"]["max_s"], timing["loop_s"]);
}

TEST_F(Latency, IsPartOfTheJsonAndOfNoOtherFile) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out("a"), "--latency", "--json"});
  EXPECT_EQ(run.json()[0]["step_latency"], json_file("a/timing.json")["step_latency"]);
  EXPECT_FALSE(json_file("a/summary.json").contains("step_latency"));
  // The same as a scenario that says so itself; but for times, the results are those without.
  hapbench({"run", "single_spring", "--out", out("b"), "--set", "record.timing=true"});
  test::expect_same_files(directory_ / "a", directory_ / "b", {"timing.json"});
  hapbench({"run", "single_spring", "--out", out("c")});
  EXPECT_EQ(test::read_file(directory_ / "a/trajectory.csv"), test::read_file(directory_ / "c/trajectory.csv"));
}

TEST_F(Latency, RefusesMoreStepsThanItKeeps) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out(), "--latency", "--set", "time.steps=30000000",
                                   "--set", "record.trajectory=false"});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("/record/timing: got 3e+07 timed steps; allowed: at most 2e+07"), std::string::npos)
      << run.err;
  EXPECT_EQ(lines_of(run.err).size(), 1u);
  EXPECT_TRUE(test::names_below(directory_.path()).empty());
}

}  // namespace
}  // namespace hapbench::run_test
