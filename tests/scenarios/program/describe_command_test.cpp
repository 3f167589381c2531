#include <gtest/gtest.h>

#include <set>

#include "algorithms/registry.hpp"
#include "results/io/json_text.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/descriptions.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/schema_text.hpp"
#include "scenarios/studies/stability/classify.hpp"
#include "scenarios/studies/stability/judged_run.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "sim/loop/integrators/integrator.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// list, describe, validate
namespace hapbench::describe_command_test {
namespace {

using test::hapbench;
using test::lines_of;
using test::ProgramRun;

TEST(ListCommand, NamesAllThereIs) {
  const ProgramRun run = hapbench({"list"});
  EXPECT_EQ(run.status, 0);
  std::set<std::string> names;
  for (const Json& entry : hapbench({"list", "--json"}).json()) {
    names.insert(entry["name"]);
    const std::string name = entry["name"];
    // Scenarios that differ in their algorithm share a line: "springs_limited_*", and the algorithms.
    const bool stands_there =
        run.out.find("  " + name + " ") != std::string::npos || run.out.find("  " + name + "\n") != std::string::npos;
    bool is_shared = false;
    for (const AlgorithmEntry& algorithm : algorithms()) {
      const std::string end = std::string("_") + algorithm.info->name;
      is_shared |= name.ends_with(end) &&
                   run.out.find("  " + name.substr(0, name.size() - end.size()) + "_*") != std::string::npos;
    }
    EXPECT_TRUE(stands_there || is_shared) << entry;
  }
  for (const AlgorithmEntry& entry : algorithms()) EXPECT_TRUE(names.contains(entry.info->name)) << entry.info->name;
  for (const DepthModelEntry& entry : depth_models()) EXPECT_TRUE(names.contains(entry.info->name)) << entry.info->name;
  for (const IntegratorEntry* integrator : kIntegrators) {
    EXPECT_TRUE(names.contains(integrator->info.name)) << integrator->info.name;
  }
  for (const std::string& name : environment_names()) EXPECT_TRUE(names.contains(name)) << name;
  for (const BundledScenario& bundled : bundled_scenarios()) EXPECT_TRUE(names.contains(bundled.name)) << bundled.name;
  EXPECT_EQ(hapbench({"list", "--quiet"}).out, "");
}

TEST(DescribeCommand, ExplainsEveryListedName) {
  for (const Json& entry : hapbench({"list", "--json"}).json()) {
    const std::string name = entry["name"];
    const ProgramRun run = hapbench({"describe", name});
    EXPECT_EQ(run.status, 0) << name << run.err;
    EXPECT_NE(run.out.find(name), std::string::npos) << run.out;
    EXPECT_EQ(run.err, "") << name;
    EXPECT_TRUE(hapbench({"describe", name, "--json"}).json().is_structured()) << name;
  }
}

TEST(DescribeCommand, GivesTheFormulaTheSourceAndTheParametersOfAnAlgorithm) {
  const ProgramRun run = hapbench({"describe", "shaped_stiffness"});
  for (const char* part : {"formula", "source", "known failure", "rendering.iterations", "default", ">= 0"}) {
    EXPECT_NE(run.out.find(part), std::string::npos) << part;
  }
}

TEST(DescribeCommand, GivesBothMeaningsOfAName) {
  const ProgramRun run = hapbench({"describe", "normal_projection"});
  EXPECT_NE(run.out.find("algorithm normal_projection"), std::string::npos);
  EXPECT_NE(run.out.find("depth model normal_projection"), std::string::npos);
  EXPECT_EQ(hapbench({"describe", "normal_projection", "--json"}).json().size(), 2u);
}

TEST(DescribeCommand, GivesATypeOfEveryFieldThatHasIt) {
  const ProgramRun run = hapbench({"describe", "mesh"});
  for (const char* part : {"of environment", "spacing_m", "of tool", "closed surface"}) {
    EXPECT_NE(run.out.find(part), std::string::npos) << part << run.out;
  }
}

TEST(DescribeCommand, GivesFieldsWithDefaultRangeAndMeaning) {
  const ProgramRun run = hapbench({"describe", "rendering.stiffness_N_per_m"});
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.out.find("number >= 0 <= 1"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("20000"), std::string::npos) << run.out;
  const std::string all = hapbench({"describe", "scenario"}).out;
  for (const char* field : {"time.step_s", "rendering.limits.max_force_N", "record.every", "bounds.speed_m_per_s"}) {
    EXPECT_NE(all.find(field), std::string::npos) << field;
  }
}

TEST(DescribeCommand, FindsAFieldByTheEndOfItsPath) {
  EXPECT_NE(hapbench({"describe", "torque"}).out.find("record.torque\n"), std::string::npos);
  const std::string algorithm = hapbench({"describe", "algorithm"}).out;
  EXPECT_NE(algorithm.find("rendering.algorithm\n"), std::string::npos) << algorithm;
  EXPECT_NE(algorithm.find("hapbench list algorithms"), std::string::npos) << algorithm;
  EXPECT_NE(hapbench({"plot", "--help"}).out.find("torque (needs"), std::string::npos);
}

TEST(DescribeCommand, ExplainsEveryField) {
  for (const std::string& path : scenario_field_paths()) {
    if (path.starts_with("expect.metrics.")) continue;  // as every metric
    const ProgramRun run = hapbench({"describe", path});
    EXPECT_EQ(run.status, 0) << path << run.err;
    EXPECT_NE(run.out.find(path + "\n"), std::string::npos) << path << run.out;
  }
}

TEST(DescribeCommand, SaysOfWhichTypeAFieldIs) {
  const std::string grid = hapbench({"describe", "environment.grid_m"}).out;
  EXPECT_NE(grid.find("of environment.type \"block_with_hole\""), std::string::npos) << grid;
  EXPECT_NE(grid.find("of environment.type \"point_shell\", environment.type \"mesh\""), std::string::npos) << grid;
  const std::string delay = hapbench({"describe", "device.servo.delay_samples"}).out;
  EXPECT_NE(delay.find("of device.type \"admittance\""), std::string::npos) << delay;
  const std::string types = hapbench({"describe", "hand.type"}).out;
  for (const std::string& type : type_names("hand"))
    EXPECT_NE(types.find("\"" + type + "\""), std::string::npos) << types;
}

TEST(DescribeCommand, LeavesBoundsOnMetricsToTheListOfMetrics) {
  const ProgramRun run = hapbench({"describe", "expect.metrics"});
  EXPECT_NE(run.out.find("hapbench list metrics"), std::string::npos) << run.out;
  EXPECT_LE(lines_of(run.out).size(), 4u);
  EXPECT_NE(hapbench({"list", "metrics"}).out.find("  force_step_p99_N "), std::string::npos);
}

TEST(DescribeCommand, ExplainsTheWordsAndHeadingsThatResultsHave) {
  std::vector<std::string> words = {"reproduced in kind"};
  for (const OutcomeInfo& outcome : outcome_infos()) words.emplace_back(outcome.name);
  for (const MotionClass motion : kMotionClasses) words.emplace_back(motion_class_name(motion));
  for (const RunVerdict verdict : {RunVerdict::thrown_out, RunVerdict::no_contact})
    words.emplace_back(run_verdict_name(verdict));
  for (const std::string& word : words) EXPECT_EQ(hapbench({"describe", word}).status, 0) << word;
  for (const RunHeading& heading : kRunHeadings)
    EXPECT_EQ(hapbench({"describe", heading.title}).status, 0) << heading.title;
  EXPECT_EQ(hapbench({"describe", ">30Hz rms N"}).out.find("metric force_rms_above_30Hz_N"), 0u);
}

TEST(DescribeCommand, ExplainsEveryClaim) {
  for (const Claim& claim : all_claims()) {
    const ProgramRun run = hapbench({"describe", lower_case(claim.id)});
    EXPECT_EQ(run.out.find(std::string("claim ") + claim.id + ", verdict on record: "), 0u) << run.out << run.err;
  }
  const ProgramRun list = hapbench({"list", "claims"});
  EXPECT_EQ(lines_of(list.out)[0], "claims");
  EXPECT_NE(list.out.find("  C5   not reproduced"), std::string::npos) << list.out;
}

TEST(DescribeCommand, ShowsWhatNamesAPlaceOfTheThesis) {
  for (const char* name : {"Fig. A.2", "fig a.2", "figure_A.2", "figure_A.2_springs.svg"}) {
    const Json place = hapbench({"describe", name, "--json"}).json();
    EXPECT_EQ(place["claims"], Json::array({"A1"})) << name;
    EXPECT_NE(place["scenarios"].dump().find("peg_in_hole_2d_shaped_stiffness"), std::string::npos) << name;
  }
  // Section A.2 is about the springs, and Fig. 2 has the parts 2c and 2d.
  EXPECT_EQ(hapbench({"describe", "section A.2", "--json"}).json()["claims"], Json::array({"A2", "A3"}));
  EXPECT_EQ(hapbench({"describe", "A.2", "--json"}).json()["claims"], Json::array({"A1", "A2", "A3", "D2"}));
  EXPECT_EQ(hapbench({"describe", "Fig. 2", "--json"}).json()["claims"], Json::array({"V1", "V2"}));
  const ProgramRun none = hapbench({"describe", "Fig. 99"});
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("names Fig. 99 of the thesis"), std::string::npos) << none.err;
}

TEST(DescribeCommand, PrintsTheSchema) {
  EXPECT_EQ(hapbench({"describe", "schema"}).out, json_text(scenario_schema()));
}

TEST(DescribeCommand, ExplainsAScenarioFileOfTheCurrentDirectory) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "mine.json", test::minimal_scenario("point_shell").dump());
  test::ProgramOptions options;
  options.directory = directory.path();
  const ProgramRun run = hapbench({"describe", "mine.json"}, options);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("scenario mine"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("environment.file=\"shell.csv\""), std::string::npos) << run.out;
}

TEST(DescribeCommand, ExplainsEveryMetric) {
  for (const auto& [name, unit, meaning, value] : metrics_without_values(1)) {
    const ProgramRun run = hapbench({"describe", name});
    EXPECT_EQ(run.status, 0) << name << run.err;
    EXPECT_EQ(run.out.find("metric " + name), 0u) << run.out;
  }
  EXPECT_NE(hapbench({"describe", "metrics"}).out.find("force_step_p99_N [N]"), std::string::npos);
}

/// As a test of all that a run can write.
TEST(DescribeCommand, ExplainsEveryColumnOfEveryFileOfARun) {
  const test::TemporaryDirectory directory;
  Json json = test::minimal_scenario("block_with_hole");
  json["initial"]["position_m"] = {0.003, 0.0, 0.0};  // on the flat
  json["record"] = {
      {"contacts", true}, {"stiffness_tensor", true}, {"energy", true},         {"ideal_trajectory", true},
      {"pose", true},     {"torque", true},           {"ratio_iterations", {3}}};
  test::write_plainly(directory / "a.json", json.dump());
  const std::string out = (directory / "out").string();
  ASSERT_EQ(hapbench({"run", (directory / "a.json").string(), "--out", out}).status, 0);
  const Json columns = Json::parse(test::read_file(directory / "out/columns.json"));
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    if (entry.path().extension() != ".csv") continue;
    const std::string file = entry.path().filename().string();
    std::string header;
    for (const Json& column : columns.at(file)) {
      header += (header.empty() ? "" : ",") + column["name"].get<std::string>();
      const ProgramRun run = hapbench({"describe", column["name"].get<std::string>()});
      EXPECT_NE(run.out.find(file), std::string::npos) << column << run.out << run.err;
    }
    EXPECT_EQ(lines_of(test::read_file(entry.path()))[0], header) << file;
    EXPECT_EQ(hapbench({"describe", file, "--json"}).json()["columns"], columns[file]) << file;
    ++files;
  }
  EXPECT_EQ(files, 6u);
  const Json metrics = Json::parse(test::read_file(directory / "out/summary.json"))["metrics"];
  for (const auto& [name, value] : metrics.items()) {
    if (name == "final_position_m") continue;
    EXPECT_NE(columns["summary.json"].dump().find("\"" + name + "\""), std::string::npos) << name;
  }
}

TEST(DescribeCommand, SuggestsMetricsColumnsAndFiles) {
  for (const auto& [wrong, right] : {std::pair{"force_step_p9_N", "force_step_p99_N"},
                                     std::pair{"fmeas_x", "fmeas_x_N"}, std::pair{"trajectry.csv", "trajectory.csv"}}) {
    const ProgramRun run = hapbench({"describe", wrong});
    EXPECT_EQ(run.status, 2);
    EXPECT_NE(run.err.find("nearest valid name: \"" + std::string(right) + "\""), std::string::npos) << run.err;
  }
}

TEST(DescribeCommand, RefusesAnUnknownNameAndSuggestsTheNearest) {
  const ProgramRun run = hapbench({"describe", "shaped_stifness"});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("nearest valid name: \"shaped_stiffness\""), std::string::npos) << run.err;
  EXPECT_EQ(lines_of(run.err).size(), 1u);
  for (const char* name : {"", "rendering.", "rendering.stiffness", "time.step_s.x", "no such thing"}) {
    EXPECT_EQ(hapbench({"describe", name}).status, 2) << name;
  }
}

class ValidateCommand : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    test::write_plainly(directory_ / name, text);
    return (directory_ / name).string();
  }
  test::TemporaryDirectory directory_;
};

TEST_F(ValidateCommand, AcceptsEveryBundledScenario) {
  std::vector<std::string> arguments = {"validate"};
  for (const BundledScenario& bundled : bundled_scenarios()) arguments.push_back(bundled.file.string());
  const ProgramRun run = hapbench(arguments);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const auto lines = lines_of(run.out);
  EXPECT_EQ(
      std::count_if(lines.begin(), lines.end(), [](const std::string& line) { return line.ends_with(": valid"); }),
      static_cast<std::ptrdiff_t>(arguments.size() - 1));
}

TEST_F(ValidateCommand, JudgesEachFileAndGoesOnAfterABadOne) {
  const std::string good = write("good.json", test::minimal_scenario("plane").dump()), bad = write("bad.json", "{}");
  const ProgramRun run = hapbench({"validate", bad, good, "no_such_scenario"});
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out.find(good + ": valid\n  environment  10 x 10 x 0 mm "), 0u) << run.out;
  const auto errors = lines_of(run.err);
  ASSERT_EQ(errors.size(), 3u);
  EXPECT_EQ(errors[0].find("hapbench: error: " + bad + ": missing field \"time\""), 0u);
  EXPECT_EQ(errors[1].find("hapbench: error: " + bad + ": missing field \"environment\""), 0u);
  EXPECT_EQ(errors[2].find("hapbench: error: no_such_scenario: "), 0u);
}

TEST_F(ValidateCommand, ReadsTheFilesAScenarioNames) {
  const std::string file = write("shell.json", test::minimal_scenario("point_shell").dump());
  EXPECT_EQ(hapbench({"validate", file}).status, 2);
  write("shell.csv", "x_m,y_m,z_m,nx,ny,nz\n0,0,0,0,0,1\n");
  EXPECT_EQ(hapbench({"validate", file}).status, 0);
}

TEST_F(ValidateCommand, PrintsVerdictsAsJson) {
  const std::string good = write("good.json", test::minimal_scenario("plane").dump()), bad = write("bad.json", "{}");
  const Json verdicts = hapbench({"validate", good, bad, "--json"}).json();
  EXPECT_EQ(verdicts[0]["file"], good);
  EXPECT_EQ(verdicts[0]["valid"], true);
  EXPECT_EQ(verdicts[0]["steps"], 20);
  EXPECT_EQ(verdicts[1]["valid"], false);
  EXPECT_NE(verdicts[1]["error"].get<std::string>().find("missing field"), std::string::npos);
  EXPECT_EQ(hapbench({"validate", good, "--quiet"}).out, "");
  EXPECT_EQ(hapbench({"validate", good, "--set", "time.steps=30", "--json"}).json()[0]["steps"], 30);
}

TEST_F(ValidateCommand, WritesNothing) {
  test::ProgramOptions options;
  options.directory = directory_.path();
  hapbench({"validate", "single_spring"}, options);
  EXPECT_EQ(directory_.entries(), std::vector<std::string>{});
}

}  // namespace
}  // namespace hapbench::describe_command_test
