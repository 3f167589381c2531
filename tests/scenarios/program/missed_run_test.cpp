#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// A run that missed its object says so: outcome, warning, exit status.
namespace hapbench::missed_run_test {
namespace {

using test::hapbench;

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
}

TEST_F(MissedRun, PushedPastTheObjectTellsWhereItEnded) {
  const test::ProgramRun missed =
      run({"poke_plane", "--set", "motion.position={\"type\":\"free\"}", "--set",
           "hand={\"type\":\"force\",\"x_N\":1,\"z_N\":-1}", "--set", "initial.position_m=[0,0,0.0001]", "--set",
           "time={\"step_s\":0.0005,\"duration_s\":2}"});
  EXPECT_EQ(missed.status, 3);
  EXPECT_EQ(summary()["outcome"], "lost_contact");
  EXPECT_NE(missed.err.find("away from the environment"), std::string::npos) << missed.err;
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

TEST_F(MissedRun, ValidateSaysWhatItSees) {
  const test::ProgramRun seen = hapbench({"validate", "mesh_molar"});
  EXPECT_EQ(seen.status, 0);
  for (const char* part :
       {"mm (x ", " points, closed\n", "  start        starts ", "steps of 0.4883 ms", "  writes       about "}) {
    EXPECT_NE(seen.out.find(part), std::string::npos) << part << "\n" << seen.out;
  }
  const Json facts = hapbench({"validate", "mesh_molar", "--json"}).json()[0];
  EXPECT_EQ(facts["environment"]["closed"], true);
  EXPECT_GT(facts["start"]["gap_m"], 0.0);
}

}  // namespace
}  // namespace hapbench::missed_run_test
