#include <gtest/gtest.h>

#include <algorithm>

#include "scenarios/format/text_lines.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// hapbench run: files, tables, times. How runs end and what standard error says is in tests/data/golden/ends.txt.
namespace hapbench::run_test {
namespace {

using Names = std::vector<std::string>;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;

class RunCommand : public testing::Test {
 protected:
  std::string write_scenario(const std::string& name, const Json& json) const {
    test::write_plainly(directory_ / name, json.dump());
    return (directory_ / name).string();
  }
  std::string out(const std::string& name = "out") const { return (directory_ / name).string(); }
  Json json_file(const std::string& name) const { return Json::parse(test::read_file(directory_ / name)); }
  Json summary(const std::string& directory = "out") const { return json_file(directory + "/summary.json"); }

  test::TemporaryDirectory directory_;
};

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

TEST_F(RunCommand, ShowsSevenColumnsAndARowForEachScenario) {
  const auto lines = lines_of(hapbench({"run", "single_spring", "single_damper", "--out", out()}).out);
  ASSERT_EQ(lines.size(), 11u);
  EXPECT_EQ(words_of(lines[2]).size(), 7u) << lines[2];
  EXPECT_EQ(lines[3].find("single_spring  summation  completes"), 0u) << lines[3];
  EXPECT_EQ(lines[4].find("single_damper  summation  completes"), 0u) << lines[4];
  EXPECT_EQ(lines[6].find("99 % of the steps take at most "), 0u) << lines[6];
  EXPECT_EQ(lines[8], "wrong with single_damper: damping (0.998)");
  EXPECT_EQ(lines.back(), "results in " + out());
  const auto wide = lines_of(hapbench({"run", "single_spring", "--wide", "--out", out()}).out);
  EXPECT_EQ(words_of(wide[2]).size(), 14u) << wide[2];
}

TEST_F(RunCommand, OverridesFieldsForEveryScenarioAndPrintsTheSummariesAsJson) {
  const ProgramRun run = hapbench({"run", "single_spring", "single_damper", "--out", out(), "--set", "time.steps=5",
                                   "--set", "initial.position_m=[0.002, 0, 0]", "--json"});
  EXPECT_EQ(run.status, 0) << run.err;
  const Json json = run.json();
  ASSERT_EQ(json.size(), 2u);
  for (const Json& one : json) EXPECT_EQ(one["steps"], 5);
  EXPECT_EQ(json[0], summary("out/single_spring"));
  const auto rows = lines_of(test::read_file(directory_ / "out/single_damper/trajectory.csv"));
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(test::cells_of(rows[1])[2], "0.002");
}

TEST_F(RunCommand, ThatDivergesKeepsWhatWasRecorded) {
  EXPECT_EQ(hapbench({"run", "single_spring_unstable", "--out", out()}).status, 0) << "it is expected";
  const Json s = summary(), divergence = s["divergence"];
  EXPECT_EQ(s["outcome"], "diverges");
  EXPECT_GT(divergence["magnitude"], divergence["bound"]);
  // All rows before the one that diverged are there.
  const std::size_t step = divergence["step"];
  const auto rows = lines_of(test::read_file(directory_ / "out/trajectory.csv"));
  EXPECT_EQ(rows.size(), 1 + step);
  EXPECT_EQ(s["steps"], step);
  EXPECT_EQ(test::cells_of(rows.back())[0], std::to_string(step - 1));
  EXPECT_NEAR(divergence["time_s"].get<double>(), 0.0005 * static_cast<double>(step), 1e-12);
  // In the first row.
  hapbench({"run", "single_spring", "--out", out(), "--set", "bounds.position_m=1e-9"});
  EXPECT_EQ(summary()["divergence"]["step"], 0);
  EXPECT_EQ(summary()["metrics"]["final_position_m"], nullptr);
  EXPECT_EQ(lines_of(test::read_file(directory_ / "out/trajectory.csv")).size(), 1u);
}

TEST_F(RunCommand, TakesTheBeginningOfSettledContactFromTheScenario) {
  const auto settled = [this](const char* from) {
    hapbench({"run", "single_spring", "--out", out(), "--set", from});
    return summary()["metrics"]["settled_s"].get<double>();
  };
  EXPECT_DOUBLE_EQ(settled("metrics={}"), 0.15) << "0.2 s in contact, of which 0.05 s are the landing";
  EXPECT_DOUBLE_EQ(settled("metrics.from_s=0"), 0.2);
  EXPECT_TRUE(summary()["metrics"]["landing_force_max_N"].is_null());
  EXPECT_DOUBLE_EQ(settled("metrics.settling_s=0.125"), 0.075);
}

TEST_F(RunCommand, ExpectsOfTheIdealTrajectoryWhatTheRecordedRowsAre) {
  const std::string tenth = write_scenario("tenth.json", Json::parse(R"({
    "extends": "rotate_in_hole",
    "time": {"step_s": 0.0005, "steps": 50},
    "record": {"every": 5, "ideal_trajectory": true},
    "expect": {"outcome": "completes", "metrics": {"ideal_trajectory.gentle.rows": {"min": 10, "max": 10}}}})"));
  EXPECT_EQ(hapbench({"run", tenth, "--out", out()}).status, 0);
  EXPECT_EQ(hapbench({"run", tenth, "--out", out(), "--set", "record.every=10"}).status, 0) << "another run";
}

TEST_F(RunCommand, KeepsItsWarnings) {
  const std::string said =
      hapbench({"run", "mesh_molar", "--out", out(), "--set", "environment.scale=1e-6", "--set", "expect={}"}).err;
  const Json warnings = summary()["warnings"];
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(said.find(warnings[0].get<std::string>()), std::string::npos) << said;
}

/// `hapbench run --latency` and record.timing.
class Latency : public RunCommand {};

TEST_F(Latency, TimesEveryStepAndPrintsATable) {
  const ProgramRun run = hapbench({"run", "drill_in_hole", "single_damper", "--out", out(), "--latency"});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto lines = lines_of(run.out);
  const auto header = std::ranges::find_if(lines, [](const auto& line) { return line.find("p99.9 us") != line.npos; });
  ASSERT_LT(header + 3, lines.end()) << run.out;
  EXPECT_EQ(header[2].find("drill_in_hole"), 0u);
  EXPECT_EQ(header[3].find("single_damper"), 0u);
  EXPECT_EQ(json_file("out/drill_in_hole/timing.json")["step_latency"]["steps"], summary("out/drill_in_hole")["steps"]);
}

TEST_F(Latency, IsPartOfTheJsonAndOfNoOtherFile) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out("a"), "--latency", "--json"});
  EXPECT_EQ(run.json()[0]["step_latency"], json_file("a/timing.json")["step_latency"]);
  EXPECT_FALSE(summary("a").contains("step_latency"));
  // The same as a scenario that says so itself; but for times, the results are those without.
  hapbench({"run", "single_spring", "--out", out("b"), "--set", "record.timing=true"});
  test::expect_same_files(directory_ / "a", directory_ / "b", {"timing.json"});
  hapbench({"run", "single_spring", "--out", out("c")});
  EXPECT_EQ(test::read_file(directory_ / "a/trajectory.csv"), test::read_file(directory_ / "c/trajectory.csv"));
}

}  // namespace
}  // namespace hapbench::run_test
