#include <gtest/gtest.h>

#include <regex>

#include "scenarios/input/mesh_file.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// hapbench new and shell, and effective scenarios: files that are read again.
namespace hapbench::start_and_shell_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::ProgramRun;

/// `hapbench new`
class NewCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  std::string data(const std::string& name) const { return (test::data_directory() / name).string(); }
  test::TemporaryDirectory directory_;
};

TEST_F(NewCommand, WritesScenariosOfEveryKindThatRunAtOnceAndTouch) {
  const Json kinds = hapbench({"new", "--json"}).json();
  ASSERT_FALSE(kinds.empty());
  for (const Json& entry : kinds) {
    const std::string kind = entry["kind"], file = path(kind + ".json");
    std::vector<std::string> arguments = {"new", kind, "--out", file};
    const std::string source = kind == "mesh" || kind == "tool" ? "cube.obj"
                               : kind == "shell"                ? "shell.csv"
                                                                : "stroke.csv";
    if (kind == "mesh" || kind == "tool" || kind == "shell" || kind == "stroke")
      arguments.insert(arguments.end(), {"--from", data(source)});
    const ProgramRun written = hapbench(arguments);
    ASSERT_EQ(written.status, 0) << kind << ": " << written.err;
    for (const std::string& line : test::lines_of(written.out)) EXPECT_LE(line.size(), 160u) << line;
    const ProgramRun run = hapbench({"run", file, "--out", path(kind), "--json"});
    ASSERT_EQ(run.status, 0) << kind << ": " << run.err;
    const Json summary = run.json()[0];
    EXPECT_EQ(summary["outcome"], "completes") << kind;
    EXPECT_GT(summary["metrics"]["steps_in_contact"], 0) << kind;
  }
}

TEST_F(NewCommand, GuessesTheUnitOfAMesh) {
  const std::string cube = test::read_file(data("cube.obj"));
  // A cube of 10, of 1 and of 0.01: millimetres, centimetres and metres.
  const auto scale_of = [&](const std::string& corner, const std::string& name) {
    std::string text = cube;
    for (std::size_t at = 0; (at = text.find('5', at)) != std::string::npos && at < text.find("\nf ");
         at += corner.size())
      text.replace(at, 1, corner);
    test::write_plainly(directory_ / (name + ".obj"), text);
    EXPECT_EQ(hapbench({"new", "mesh", "--from", path(name + ".obj"), "--out", path(name + ".json")}).status, 0);
    const Json json = Json::parse(test::read_file(directory_ / (name + ".json")));
    EXPECT_EQ(json["environment"]["file"], name + ".obj") << "from where the scenario stands";
    return json["environment"]["scale"].get<double>();
  };
  EXPECT_EQ(scale_of("5", "millimetres"), 0.001);
  EXPECT_EQ(scale_of("0.6", "centimetres"), 0.01);
  EXPECT_EQ(scale_of("0.006", "metres"), 1.0);
}

TEST_F(NewCommand, DragsOverAMeshToo) {
  ASSERT_EQ(hapbench({"new", "drag", "--from", data("cube.obj"), "--out", path("drag.json")}).status, 0);
  const Json summary = hapbench({"run", path("drag.json"), "--out", path("run"), "--json"}).json()[0];
  EXPECT_EQ(summary["outcome"], "completes");
  EXPECT_GT(summary["metrics"]["steps_in_contact"], summary["steps"].get<int>() / 2);
}

TEST_F(NewCommand, NeverOverwrites) {
  test::write_plainly(directory_ / "plane.json", "mine");
  const ProgramRun run = hapbench({"new", "plane", "--out", path("plane.json")});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("plane.json exists; choose another with --out"), std::string::npos) << run.err;
  EXPECT_EQ(test::read_file(directory_ / "plane.json"), "mine");
}

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

TEST_F(ShellCommand, RefusesADirectoryInPlaceOfItsFile) {
  fs::create_directory(path("d.csv"));
  const ProgramRun run = hapbench({"shell", "peg_in_hole_2d_mean", "--out", path("d.csv")});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("is a directory"), std::string::npos) << run.err;
}

/// The text without the files that its lines name in front of a JSON pointer.
std::string without_files(const std::string& text) {
  return std::regex_replace(text, std::regex("[^\n]*\\.json: /"), "/");
}

/// Runs `scenario`, then the effective scenario of that run, and compares all files.
void expect_reproduced(const std::string& scenario, const fs::path& directory, const std::string& first,
                       const std::string& second, const std::vector<std::string>& ignored) {
  const test::ProgramRun run = hapbench({"run", scenario, "--out", (directory / first).string()});
  ASSERT_EQ(run.status, 0) << run.err;
  const test::ProgramRun again = hapbench(
      {"run", (directory / first / "scenario.effective.json").string(), "--out", (directory / second).string()});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(without_files(again.err), without_files(run.err));  // warnings about the run
  test::expect_same_files(directory / first, directory / second, ignored);
}

/// Scenarios with files, records of every kind and odd settings, in a directory of their own.
class EffectiveScenarioWithFiles : public testing::Test {
 protected:
  EffectiveScenarioWithFiles() {
    fs::create_directories(directory_ / "my scenes");
    for (const char* file : {"cube.obj", "shell.csv", "stroke.csv"}) {
      fs::copy_file(test::data_directory() / file, directory_.path() / "my scenes" / file);
    }
  }
  std::string write(const test::NamedScenario& scenario) const {
    const fs::path file = directory_.path() / "my scenes" / (scenario.name + ".json");
    test::write_plainly(file, scenario.json.dump());
    return file.string();
  }
  test::TemporaryDirectory directory_;
};

TEST_F(EffectiveScenarioWithFiles, ReproducesTheRunFromADirectoryOfTheSameDepth) {
  for (const test::NamedScenario& scenario : test::rich_scenarios()) {
    SCOPED_TRACE(scenario.name);
    expect_reproduced(write(scenario), directory_.path(), "a_" + scenario.name, "b_" + scenario.name, {"timing.json"});
  }
}

TEST_F(EffectiveScenarioWithFiles, ReproducesTheRunFromAnotherDirectory) {
  // Its paths are then written differently; everything else is the same, the hash of the scenario included.
  for (const test::NamedScenario& scenario : test::rich_scenarios()) {
    SCOPED_TRACE(scenario.name);
    expect_reproduced(write(scenario), directory_.path(), "first/" + scenario.name, "b/deeper/still/" + scenario.name,
                      {"timing.json", "scenario.effective.json"});
  }
}

TEST_F(EffectiveScenarioWithFiles, ReproducesTheRunThroughALinkedOutputDirectory) {
  fs::create_directories(directory_ / "disk/deep/results");
  fs::create_directory_symlink(directory_ / "disk/deep/results", directory_ / "link");
  for (const test::NamedScenario& scenario : test::rich_scenarios()) {
    SCOPED_TRACE(scenario.name);
    expect_reproduced(write(scenario), directory_.path(), "link/" + scenario.name, "b_" + scenario.name,
                      {"timing.json", "scenario.effective.json"});
  }
}

TEST_F(EffectiveScenarioWithFiles, StillMeansTheSameWhenTheDirectoryMovesAsAWhole) {
  const fs::path before = directory_ / "project", after = directory_ / "elsewhere/project";
  fs::create_directories(before);
  fs::create_directories(directory_ / "elsewhere");
  fs::rename(directory_ / "my scenes", before / "scenes");
  const test::NamedScenario scenario = test::rich_scenarios()[2];
  ASSERT_EQ(scenario.name, "recorded_shell");
  test::write_plainly(before / "scenes/s.json", scenario.json.dump());
  ASSERT_EQ(hapbench({"run", (before / "scenes/s.json").string(), "--out", (before / "out").string()}).status, 0);
  fs::rename(before, after);
  const test::ProgramRun run =
      hapbench({"run", (after / "out/scenario.effective.json").string(), "--out", (after / "again").string()});
  ASSERT_EQ(run.status, 0) << run.err;
  test::expect_same_files(after / "out", after / "again");
}

}  // namespace
}  // namespace hapbench::start_and_shell_test
