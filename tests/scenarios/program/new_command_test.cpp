#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// `hapbench new`
namespace hapbench::new_command_test {
namespace {

using test::hapbench;
using test::ProgramRun;

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

TEST_F(NewCommand, FindsTheTipOfAToolThatLiesSomewhere) {
  // A pyramid of 8 mm along x, its tip at (20, 3, 4).
  test::write_plainly(
      directory_ / "pick.obj",
      "v 20 3 4\nv 28 2 3\nv 28 4 3\nv 28 4 5\nv 28 2 5\nf 1 3 2\nf 1 4 3\nf 1 5 4\nf 1 2 5\nf 2 3 4 5\n");
  const ProgramRun made = hapbench({"new", "tool", "--from", path("pick.obj"), "--out", path("pick.json")});
  ASSERT_EQ(made.status, 0) << made.err;
  for (const std::string& line : test::lines_of(made.out)) EXPECT_LE(line.size(), 160u) << line;
  const Json pick = Json::parse(test::read_file(directory_ / "pick.json"));
  EXPECT_EQ(pick["tool"]["tip_m"], Json::parse("[0.02, 0.003, 0.004]"));
  EXPECT_EQ(pick["tool"]["tip_axis"], Json::parse("[-1.0, 0.0, 0.0]"));
  EXPECT_EQ(pick["initial"]["position_m"], Json::parse("[0.0, 0.0, 0.001]"));
  const ProgramRun valid = hapbench({"validate", path("pick.json")});
  EXPECT_EQ(valid.err, "");
  const ProgramRun odd = hapbench({"validate", path("pick.json"), "--set", "tool.tip_m=[0,0,0]"});
  EXPECT_EQ(odd.status, 0);
  EXPECT_NE(odd.err.find("the tool lies 20.3 mm away from its tip centre"), std::string::npos) << odd.err;
}

TEST_F(NewCommand, DragsOverAMeshToo) {
  ASSERT_EQ(hapbench({"new", "drag", "--from", data("cube.obj"), "--out", path("drag.json")}).status, 0);
  const Json summary = hapbench({"run", path("drag.json"), "--out", path("run"), "--json"}).json()[0];
  EXPECT_EQ(summary["outcome"], "completes");
  EXPECT_GT(summary["metrics"]["steps_in_contact"], summary["steps"].get<int>() / 2);
}

TEST_F(NewCommand, DragsWhereTheSurfaceHasRoom) {
  // Of a plate of 10 x 2 x 2 mm, higher at its end at -x: from there the way leads on along x.
  const std::string plate =
      "v 0 -1 0\nv 10 -1 0\nv 10 1 0\nv 0 1 0\nv 0 -1 2\nv 10 -1 1.5\nv 10 1 1.5\nv 0 1 2\n"
      "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  test::write_plainly(directory_ / "plate.obj", plate);
  const ProgramRun made = hapbench({"new", "bur", "--from", path("plate.obj"), "--out", path("bur.json")});
  EXPECT_EQ(made.err, "");
  const Json json = Json::parse(test::read_file(directory_ / "bur.json"));
  EXPECT_EQ(json["hand"]["direction"], Json::parse("[1, 0, 0]")) << made.out;
  const double way = json["hand"]["speed_m_per_s"].get<double>() * 0.0005 * json["time"]["steps"].get<double>();
  EXPECT_GT(way, 0.005) << made.out;
  EXPECT_EQ(hapbench({"validate", path("bur.json")}).err, "");

  // A needle of 0.2 x 0.2 x 10 mm has none, and it is said.
  std::string needle = "v -.1 -.1 0\nv .1 -.1 0\nv .1 .1 0\nv -.1 .1 0\nv -.1 -.1 10\nv .1 -.1 10\nv .1 .1 10\n";
  needle += "v -.1 .1 10\n" + plate.substr(plate.find("f 1 4"));
  test::write_plainly(directory_ / "needle.obj", needle);
  const ProgramRun none = hapbench({"new", "bur", "--from", path("needle.obj"), "--out", path("none.json")});
  EXPECT_EQ(none.status, 0);
  EXPECT_NE(none.err.find("no way longer than"), std::string::npos) << none.err;
  EXPECT_NE(hapbench({"validate", path("none.json")}).err.find("the path of the drag ends after"), std::string::npos);
}

TEST_F(NewCommand, ExplainsEveryFieldItWrites) {
  const Json answer = hapbench({"new", "drag", "--out", path("drag.json"), "--json"}).json();
  const Json json = Json::parse(test::read_file(directory_ / "drag.json"));
  for (const auto& section : json.items()) EXPECT_TRUE(answer["fields"].contains(section.key())) << section.key();
  EXPECT_EQ(answer["fields"]["hand.speed_m_per_s"], "along the path");
}

TEST_F(NewCommand, NeverOverwrites) {
  test::write_plainly(directory_ / "plane.json", "mine");
  const ProgramRun run = hapbench({"new", "plane", "--out", path("plane.json")});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("plane.json exists; choose another with --out"), std::string::npos) << run.err;
  EXPECT_EQ(test::read_file(directory_ / "plane.json"), "mine");
}

TEST_F(NewCommand, NamesFilesAfterTheSourceAndTheKind) {
  test::ProgramOptions options;
  options.directory = directory_.path();
  for (const char* kind : {"mesh", "drag"})
    EXPECT_EQ(hapbench({"new", kind, "--from", data("cube.obj"), "--quiet"}, options).status, 0) << kind;
  EXPECT_EQ(hapbench({"new", "drag", "--quiet"}, options).status, 0);
  for (const char* file : {"cube_mesh.json", "cube_drag.json", "drag.json"})
    EXPECT_TRUE(std::filesystem::exists(directory_ / file)) << file;
}

TEST_F(NewCommand, RefusesWhatItCannotStartFrom) {
  const auto refusal = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "new");
    arguments.insert(arguments.end(), {"--out", path("x.json")});
    const ProgramRun run = hapbench(arguments);
    EXPECT_EQ(run.status, 2) << run.out;
    return run.err;
  };
  EXPECT_NE(refusal({"srings"}).find("nearest valid name: \"springs\""), std::string::npos);
  EXPECT_NE(refusal({"mesh"}).find("--from: missing"), std::string::npos);
  EXPECT_NE(refusal({"plane", "--from", data("cube.obj")}).find("starts from no file"), std::string::npos);
  EXPECT_NE(refusal({"mesh", "--from", data("shell.csv")}).find("allowed: .obj"), std::string::npos);
  EXPECT_NE(refusal({"mesh", "--from", path("none.obj")}).find("cannot be read"), std::string::npos);
  EXPECT_EQ(directory_.entries(), std::vector<std::string>{});
}

}  // namespace
}  // namespace hapbench::new_command_test
