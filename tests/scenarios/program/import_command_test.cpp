#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// `hapbench import`
namespace hapbench::import_command_test {
namespace {

using test::hapbench;
using test::ProgramRun;

class ImportCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  static std::string wipe() { return HAPBENCH_SCENARIOS "/examples/data/wipe.hapi.txt"; }
  test::TemporaryDirectory directory_;
};

TEST_F(ImportCommand, MakesAStrokeThatRunsAtOnceAndIsComparedWithItsForce) {
  const ProgramRun imported =
      hapbench({"import", wipe(), "--preset", "hapi", "--shift", "0,0,-0.001", "--out", path("stroke.csv"), "--json"});
  ASSERT_EQ(imported.status, 0) << imported.err;
  const Json report = imported.json();
  EXPECT_EQ(report["rate_Hz"], 99.0);
  EXPECT_EQ(report["resampled"], true);
  EXPECT_NEAR(report["quantum_m"][0].get<double>(), 1e-5, 1e-12);
  EXPECT_NEAR(report["quantum_force_N"].get<double>(), 0.2, 1e-7);
  EXPECT_EQ(report["has_roll"], true);
  const ProgramRun started = hapbench({"new", "stroke", "--from", path("stroke.csv"), "--out", path("stroke.json")});
  ASSERT_EQ(started.status, 0) << started.err;
  ASSERT_EQ(hapbench({"validate", path("stroke.json")}).status, 0);
  const ProgramRun run =
      hapbench({"run", path("stroke.json"), "--set", "record.force_reference=true", "--out", path("run"), "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json fidelity = run.json()[0]["fidelity"];
  EXPECT_GT(fidelity["rows"], 100);
  EXPECT_GT(fidelity["force_error_rms_N"], 0.0);
  EXPECT_EQ(test::lines_of(test::read_file(directory_ / "run/force_reference.csv"))[0],
            "step,time_s,mfx_N,mfy_N,mfz_N,force_error_x_N,force_error_y_N,force_error_z_N");
}

TEST_F(ImportCommand, SaysWhatItFoundInNarrowTables) {
  const ProgramRun imported =
      hapbench({"import", wipe(), "--preset", "hapi", "--smooth", "window=11,order=3", "--out", path("stroke.csv")});
  ASSERT_EQ(imported.status, 0) << imported.err;
  for (const char* word : {"99 Hz, resampled", "x 10 um, y 10 um, z 10 um", "K q = 0.2 N", "smoothing", "um rms",
                           "next: hapbench new stroke --from"})
    EXPECT_NE(imported.out.find(word), std::string::npos) << word << "\n" << imported.out;
}

TEST_F(ImportCommand, WritesNothingOfABadRecording) {
  test::write_plainly(directory_ / "rec.csv", "t,x,y,z\n0,0,0,0\n1,0,0\n0.5,nan,0,0\n");
  const ProgramRun run =
      hapbench({"import", path("rec.csv"), "--columns", "time=t,position=x", "--out", path("stroke.csv")});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("line 3: got 3 values; allowed: 4"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("line 4: column 2 x: got \"nan\""), std::string::npos) << run.err;
  EXPECT_EQ(test::names_below(directory_.path()), std::vector<std::string>{"rec.csv"});
}

TEST_F(ImportCommand, KeepsTheRecordingItself) {
  test::write_plainly(directory_ / "rec.csv", "0,0,0,0\n1,0,0,0\n");
  const ProgramRun run =
      hapbench({"import", path("rec.csv"), "--columns", "time=1,position=2", "--out", path("rec.csv")});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("is the recording itself"), std::string::npos) << run.err;
}

TEST_F(ImportCommand, ListsPresetsThatCanBeCopied) {
  const Json presets = hapbench({"import", "--list", "--json"}).json();
  ASSERT_GE(presets.size(), 4u);
  for (const Json& preset : presets) {
    const std::string copy = path("copy.json");
    test::write_plainly(copy, test::read_file(preset["file"].get<std::string>()));
    const ProgramRun run = hapbench({"import", path("missing"), "--preset", copy});
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.err.find("copy.json"), std::string::npos) << "the preset is right, the recording is not there";
  }
  EXPECT_NE(hapbench({"import", wipe(), "--preset", "hapy"}).err.find("nearest valid name: \"hapi\""),
            std::string::npos);
}

}  // namespace
}  // namespace hapbench::import_command_test
