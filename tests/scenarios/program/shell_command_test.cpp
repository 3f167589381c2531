#include <gtest/gtest.h>

#include "scenarios/input/mesh_file.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::shell_command_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::ProgramRun;

class ShellCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  std::vector<SurfacePoint> points_in(const std::string& name) const {
    return point_shell_in(test::read_file(directory_ / name), directory_ / name);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(ShellCommand, WritesTheEnvironmentsPointsExactlyAsCsv) {
  const ProgramRun run = hapbench({"shell", "peg_in_hole_2d_mean", "--out", path("hole.csv")});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto points = points_in("hole.csv"), expected = surface_points(Hole2d{});
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].position, expected[i].position) << i;
    EXPECT_EQ(points[i].normal, expected[i].normal) << i;
  }
  EXPECT_EQ(run.out, std::to_string(points.size()) + " points in " + path("hole.csv") + "\n");
}

TEST_F(ShellCommand, WritesPlyForViewers) {
  EXPECT_EQ(hapbench({"shell", "peg_in_hole_2d_mean", "--out", path("hole.ply")}).status, 0);
  EXPECT_EQ(test::read_file(path("hole.ply")).substr(0, 4), "ply\n");
  EXPECT_EQ(points_in("hole.ply").size(), surface_points(Hole2d{}).size());
}

TEST_F(ShellCommand, WritesWhatARunReadsAsTheSameEnvironment) {
  // The hole through a file gives the same run, bit for bit.
  ASSERT_EQ(hapbench({"shell", "peg_in_hole_2d_mean", "--out", path("hole.csv")}).status, 0);
  ASSERT_EQ(hapbench({"run", "peg_in_hole_2d_mean", "--out", path("analytic")}).status, 0);
  // Only the environment changes: what else depends on its type is in the effective scenario.
  Json json = Json::parse(test::read_file(directory_ / "analytic/scenario.effective.json"));
  json["environment"] = {{"type", "point_shell"}, {"file", "hole.csv"}, {"grid_m", 0.0001}};
  test::write_plainly(directory_ / "scene.json", json.dump());
  ASSERT_EQ(hapbench({"run", path("scene.json"), "--out", path("file")}).status, 0);
  EXPECT_EQ(test::read_file(directory_ / "file/trajectory.csv"),
            test::read_file(directory_ / "analytic/trajectory.csv"));
  EXPECT_EQ(Json::parse(test::read_file(directory_ / "file/summary.json"))["state_hash"],
            Json::parse(test::read_file(directory_ / "analytic/summary.json"))["state_hash"]);
}

TEST_F(ShellCommand, WritesWhatItReadBitForBit) {
  test::write_plainly(directory_ / "scene.json", test::minimal_scenario("point_shell").dump());
  fs::copy_file(test::data_directory() / "shell.csv", directory_ / "shell.csv");
  ASSERT_EQ(hapbench({"shell", path("scene.json"), "--out", path("again.csv")}).status, 0);
  const auto points = points_in("shell.csv"), again = points_in("again.csv");
  ASSERT_EQ(again.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(again[i].position, points[i].position);
    EXPECT_EQ(again[i].normal, points[i].normal);
  }
}

TEST_F(ShellCommand, TakesOverridesJsonAndQuiet) {
  const Json json = hapbench({"shell", "poke_plane", "--set", "environment.size_m=0.001", "--set",
                              "environment.spacing_m=0.0005", "--out", path("p.csv"), "--json"})
                        .json();
  EXPECT_EQ(json, (Json{{"points", 9}, {"file", path("p.csv")}}));
  EXPECT_EQ(hapbench({"shell", "poke_plane", "--out", path("p.csv"), "--quiet"}).out, "");
}

TEST_F(ShellCommand, CreatesTheDirectoryOfItsFile) {
  EXPECT_EQ(hapbench({"shell", "peg_in_hole_2d_mean", "--out", path("new/dir/hole.csv")}).status, 0);
  EXPECT_TRUE(fs::exists(path("new/dir/hole.csv")));
}

TEST_F(ShellCommand, RefusesSpringsAndOtherExtensionsAndWritesNothing) {
  const ProgramRun springs = hapbench({"shell", "single_spring", "--out", path("new/s.csv")});
  EXPECT_EQ(springs.status, 2);
  EXPECT_NE(springs.err.find("/environment/type: got \"springs\""), std::string::npos) << springs.err;
  const ProgramRun extension = hapbench({"shell", "peg_in_hole_2d_mean", "--out", path("new/s.stl")});
  EXPECT_EQ(extension.status, 2);
  EXPECT_NE(extension.err.find("allowed: .csv or .ply"), std::string::npos) << extension.err;
  EXPECT_FALSE(fs::exists(path("new")));
}

TEST_F(ShellCommand, RefusesADirectoryInPlaceOfItsFile) {
  fs::create_directory(path("d.csv"));
  const ProgramRun run = hapbench({"shell", "peg_in_hole_2d_mean", "--out", path("d.csv")});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("is a directory"), std::string::npos) << run.err;
}

TEST_F(ShellCommand, NeedsAFile) {
  EXPECT_EQ(hapbench({"shell", "peg_in_hole_2d_mean"}).status, 2);
}

}  // namespace
}  // namespace hapbench::shell_command_test
