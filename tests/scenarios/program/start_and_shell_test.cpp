#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <regex>

#include "scenarios/input/point_shell_file.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/meshes.hpp"

/// Tests the files that the program writes and can read again: scenarios of `hapbench new`, exported point shells and
/// effective scenarios.
namespace hapbench::start_and_shell_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::ProgramRun;

/// Fixture of the tests of `hapbench new`.
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
    const std::string kind = entry["kind"].get<std::string>(), file = path(kind + ".json");
    std::vector<std::string> arguments = {"new", kind, "--out", file};
    const std::string source = kind == "mesh" || kind == "tool" || kind == "fidelity" ? "cube.obj"
                               : kind == "shell"                                      ? "shell.csv"
                                                                                      : "stroke.csv";
    if (kind == "mesh" || kind == "tool" || kind == "fidelity" || kind == "shell" || kind == "stroke")
      arguments.insert(arguments.end(), {"--from", data(source)});
    if (source == "cube.obj") arguments.insert(arguments.end(), {"--extent", "10mm"});
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

/// Writes the mesh of a rod along x as OBJ.
void write_rod(const fs::path& file, double length, double thickness) {
  TriangleSoup rod = test::cube(0.5);
  for (Vec3& corner : rod.vertices) corner = corner.cwiseProduct(Vec3(length, thickness, thickness));
  test::write_plainly(file, test::obj_text(rod));
}

TEST_F(NewCommand, GivesAMeshItsStatedSize) {
  struct Size {
    double length;
    const char* extent;  ///< value of --extent; empty: the file is in metres
    double scale;
  };
  for (const auto& [length, extent, scale] :
       {Size{12.0, "12mm", 0.001}, Size{1.2, "1.2cm", 0.01}, Size{1.2, "0.0127m", 0.0105833}, Size{4.0, "2in", 0.0127},
        Size{86.0, "86m", 1.0}, Size{0.012, "", 1.0}, Size{1.0, "", 1.0}}) {
    write_rod(directory_ / "rod.obj", length, 0.05 * length);
    fs::remove(path("rod.json"));
    std::vector<std::string> words = {"new", "mesh", "--from", path("rod.obj"), "--out", path("rod.json")};
    if (*extent != '\0') words.insert(words.end(), {"--extent", extent});
    EXPECT_EQ(hapbench(words).status, 0) << length << extent;
    const Json json = Json::parse(test::read_file(directory_ / "rod.json"));
    EXPECT_EQ(json["environment"]["file"], "rod.obj") << "from where the scenario stands";
    EXPECT_EQ(json["environment"]["scale"], scale) << length << extent;
  }
}

TEST_F(NewCommand, TakesTheUnitOfAFileAndReportsTheScale) {
  write_rod(directory_ / "rod.obj", 17.22, 1.0);
  for (const auto& [unit, scale] : {std::pair{"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}, {"in", 0.0254}}) {
    fs::remove(path("rod.json"));
    const ProgramRun run =
        hapbench({"new", "mesh", "--from", path("rod.obj"), "--unit", unit, "--out", path("rod.json")});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(Json::parse(test::read_file(directory_ / "rod.json"))["environment"]["scale"], scale);
    EXPECT_NE(run.out.find(fmt::format("17.22 in the file, ")), std::string::npos) << run.out;
    EXPECT_NE(run.out.find(fmt::format("with scale {} (the file is in {})", scale, unit)), std::string::npos)
        << run.out;
  }
  fs::remove(path("rod.json"));
  const ProgramRun rescaled =
      hapbench({"new", "mesh", "--from", path("rod.obj"), "--extent", "17mm", "--out", path("rod.json")});
  EXPECT_NE(
      rescaled.out.find("17.22 in the file, 17 mm with scale 0.000987224, 1.3 % smaller than in mm (--unit mm keeps "
                        "its size)"),
      std::string::npos)
      << rescaled.out;
  EXPECT_EQ(hapbench({"new", "mesh", "--from", path("rod.obj"), "--extent", "17mm", "--unit", "mm"}).status, 2);
}

TEST_F(NewCommand, JudgesTheSizeOfAShellAndStartsOverTheLargestComponent) {
  std::string shell = "x_m,y_m,z_m,nx,ny,nz\n";
  for (int x = 0; x < 9; ++x)
    for (int y = 0; y < 9; ++y) shell += fmt::format("{},{},0,0,0,1\n", x, y);
  test::write_plainly(directory_ / "mm.csv", shell);
  const std::vector<std::string> words = {"new", "shell", "--from", path("mm.csv"), "--out", path("shell.json")};
  const ProgramRun refused = hapbench(words);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("the shell is 8 m long if its numbers are metres, 8 mm if they are millimetres"),
            std::string::npos)
      << refused.err;
  std::vector<std::string> confirmed = words;
  confirmed.insert(confirmed.end(), {"--unit", "m"});
  EXPECT_EQ(hapbench(confirmed).status, 0);
  // Check a small component (a speck) above and beside a cube.
  test::write_plainly(directory_ / "speck.obj",
                      test::obj_text(test::together(test::cube(0.01, {50, 0, 9}), test::cube(3.0))));
  const ProgramRun started =
      hapbench({"new", "mesh", "--from", path("speck.obj"), "--extent", "6mm", "--out", path("speck.json")});
  EXPECT_EQ(started.status, 0) << started.err;
  EXPECT_NE(started.out.find("measured without 1 of 2 components, which are specks"), std::string::npos) << started.out;
  EXPECT_NE(started.out.find("6 in the file, 6 mm with scale 0.001"), std::string::npos) << started.out;
  EXPECT_NE(started.out.find("the mesh has 2 components; the tool starts over the largest"), std::string::npos);
}

TEST_F(NewCommand, NamesTheClockOfAStrokeThatNoRunCanRecord) {
  for (const auto& [interval, says] :
       {std::pair(1e3, "microseconds: divide the times by 10^6"), {1e6, "nanoseconds: divide the times by 10^9"}}) {
    std::string stroke = "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n";
    for (int i = 0; i < 101; ++i) stroke += fmt::format("{},0,0,{},0,0,-1\n", interval * i, 1e-3 - 2e-5 * i);
    test::write_plainly(directory_ / "stroke.csv", stroke);
    const ProgramRun refused = hapbench({"new", "stroke", "--from", path("stroke.csv"), "--out", path("clock.json")});
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find(says), std::string::npos) << refused.err;
  }
}

/// Fixture with an open sheet of 8 x 8 mm with a hump; its normals point up or down.
class NewOnASheet : public NewCommand {
 protected:
  NewOnASheet() {
    const TriangleSoup up = test::sheet(16, 16, [](int i, int j) {
      const double x = 0.5 * i - 4.0, y = 0.5 * j - 4.0;
      return Vec3(x, y, std::exp(-0.1 * (x * x + y * y)));
    });
    test::write_plainly(directory_ / "up.obj", test::obj_text(up));
    test::write_plainly(directory_ / "down.obj", test::obj_text(test::reversed(up)));
  }
  /// Runs `hapbench new` and returns the written scenario. Checks that the scenario runs and that its tool touches the
  /// environment.
  Json made(std::vector<std::string> words, std::string* output = nullptr) const {
    words.insert(words.begin(), "new");
    words.insert(words.end(), {"--out", path("made.json")});
    fs::remove(path("made.json"));
    const ProgramRun written = hapbench(words);
    EXPECT_EQ(written.status, 0) << written.err;
    if (output != nullptr) *output = written.out + written.err;
    const ProgramRun run = hapbench({"run", path("made.json"), "--out", path("run"), "--json"});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_GT(run.json()[0]["metrics"]["contact_share"], 0.3);
    return Json::parse(test::read_file(directory_ / "made.json"));
  }
};

TEST_F(NewOnASheet, TurnsNormalsThatPointAwayFromTheTool) {
  const std::string as_it_is = made({"bur", "--from", path("up.obj"), "--extent", "8mm"}).dump();
  EXPECT_EQ(as_it_is.find("flip_normals"), std::string::npos) << as_it_is;
  std::string output;
  const Json turned = made({"bur", "--from", path("down.obj"), "--extent", "8mm"}, &output);
  EXPECT_EQ(turned["environment"]["flip_normals"], true);
  EXPECT_NE(output.find("its normals point away from side z and are inverted"), std::string::npos) << output;
  // Without reversed normals, the tool starts behind the surface.
  const std::string behind = hapbench({"validate", path("made.json"), "--set", "environment.flip_normals=false"}).err;
  EXPECT_NE(behind.find("1.5 mm behind the surface"), std::string::npos) << behind;
  EXPECT_EQ(hapbench({"validate", path("made.json")}).err.find("behind"), std::string::npos);
  // Without reversed normals, a tool whose tip is 0.2 mm behind the surface also starts behind the surface, although
  // its shank passes through the surface.
  const auto at = turned["initial"]["position_m"].get<std::array<double, 3>>();
  Vec3 touching(at[0], at[1], at[2]);
  touching.z() -= 0.0013;
  const std::string point = "initial.position_m=" + Json({touching.x(), touching.y(), touching.z()}).dump();
  for (const bool flip : {false, true}) {
    const std::string warnings = hapbench({"validate", path("made.json"), "--set", point, "--set",
                                           std::string("environment.flip_normals=") + (flip ? "true" : "false")})
                                     .err;
    EXPECT_EQ(warnings.find("behind the surface") != std::string::npos, !flip) << warnings;
  }
  // Commands that run the scene ask whether the normals are inverted if the tool begins inside the environment.
  for (const char* command : {"run", "compare"}) {
    const std::string err = hapbench({command, path("made.json"), "--set", "environment.flip_normals=false", "--set",
                                      "time.steps=10", "--set", "expect={}", "--out", path("out")})
                                .err;
    EXPECT_NE(err.find("the tool started inside the environment: "), std::string::npos) << err;
    EXPECT_NE(err.find("; are the normals of an open scan inverted (environment.flip_normals)?"), std::string::npos)
        << err;
  }
  EXPECT_NE(hapbench({"validate", path("made.json"), "--set", "environment.file=" + data("cube.obj")})
                .err.find("is closed, so that its outside is known"),
            std::string::npos);
}

TEST_F(NewOnASheet, StartsAtTheGivenPoint) {
  const Json below =
      made({"mesh", "--from", path("down.obj"), "--extent", "8mm", "--side=-z", "--at", "0.002,-0.001,0.0006"});
  EXPECT_FALSE(below["environment"].contains("flip_normals"));
  const auto start = below["initial"]["position_m"].get<std::array<double, 3>>();
  // One point is kept in each cube of 0.1 mm. The tolerance is the diagonal of the cube.
  EXPECT_NEAR(start[0], 0.002, 1.8e-4);
  EXPECT_NEAR(start[1], -0.001, 1.8e-4);
  EXPECT_LT(start[2], -0.0005);
  EXPECT_EQ(below["motion"]["orientation"]["up"], (Json{0, 0, -1}));
  const Json path_given =
      made({"drag", "--from", path("up.obj"), "--extent", "8mm", "--path", "-0.002,0,0", "--path", "0.002,0.001,0"});
  EXPECT_EQ(path_given["hand"]["path_m"], (Json{{-0.002, 0, 0}, {0.002, 0.001, 0}}));
  EXPECT_FALSE(path_given["hand"].contains("direction"));
  EXPECT_NEAR(path_given["initial"]["position_m"][0].get<double>(), -0.002, 2e-4);
}

/// Checks points in another unit or frame, and a point that is given twice.
TEST_F(NewOnASheet, RefusesPointsFarFromTheSurface) {
  const auto refused = [&](const std::vector<std::string>& points, const char* says) {
    std::vector<std::string> words = {"new", "drag",      "--from", path("down.obj"), "--extent",
                                      "8mm", "--side=-z", "--out",  path("far.json")};
    words.insert(words.end(), points.begin(), points.end());
    const ProgramRun run = hapbench(words);
    EXPECT_EQ(run.status, 2) << run.out;
    EXPECT_NE(run.err.find(says), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("far.json")));
  };
  refused({"--at", "2,-1,0.6"}, "away from the surface");
  refused({"--path", "0.002,-0.001,0.0006", "--path", "2,1,0.6"}, "away from the surface");
  refused({"--path", "0.002,-0.001,0.0006", "--path", "0.002,-0.001,0.0006"}, "twice");
}

TEST_F(NewOnASheet, ComesFromEverySideOfAClosedBody) {
  test::write_plainly(directory_ / "cube.obj", test::obj_text(test::cube(0.001)));
  const auto made_of_cube = [&](const std::string& kind, const std::string& side) {
    return made({kind, "--from", path("cube.obj"), "--side=" + side});
  };
  for (const std::string side : {"y", "-z"}) {
    const Json json = made_of_cube("mesh", side);
    const auto axis = static_cast<std::size_t>(side.back() - 'x');
    const double sign = side.front() == '-' ? -1.0 : 1.0;
    EXPECT_DOUBLE_EQ(json["initial"]["position_m"][axis].get<double>(), sign * 0.0025) << side;
  }
  made_of_cube("drag", "x");
}

/// Fixture with meshes whose parts are in the way of a tool that starts above them. All files are in millimetres.
class NewStart : public NewCommand {
 protected:
  /// Writes a mesh and runs `hapbench new` with it. Returns the output and the warnings.
  std::string output_of(const std::string& kind, const TriangleSoup& mesh, const std::vector<std::string>& more = {}) {
    test::write_plainly(directory_ / "mesh.obj", test::obj_text(mesh));
    fs::remove(path("made.json"));
    std::vector<std::string> words = {"new",    kind, "--from", path("mesh.obj"),
                                      "--unit", "mm", "--out",  path("made.json")};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun written = hapbench(words);
    EXPECT_EQ(written.status, 0) << written.err;
    return written.out + written.err;
  }
  /// Returns the distance between the tool and the surface at the start of the written scenario [m].
  double start_gap() const {
    const ProgramRun run = hapbench({"validate", path("made.json"), "--json"});
    EXPECT_EQ(run.status, 0) << run.err;
    return run.json()[0]["start"]["gap_m"].get<double>();
  }
  std::string outcome() const {
    return hapbench({"run", path("made.json"), "--out", path("run"), "--json"}).json()[0]["outcome"].get<std::string>();
  }
  static TriangleSoup box(const Vec3& centre, const Vec3& size) {
    TriangleSoup soup = test::cube(0.5);
    for (Vec3& corner : soup.vertices) corner = corner.cwiseProduct(size) + centre;
    return soup;
  }
};

TEST_F(NewStart, AvoidsOtherComponents) {
  // Two balls, one above the other: a tool over the lower ball would pierce the upper ball.
  const TriangleSoup ball = test::sphere(5.0, 3), balls = test::together(ball, test::scaled(ball, 1.0, {0, 0, 20}));
  const std::string over_upper = output_of("mesh", balls);
  EXPECT_NE(over_upper.find("the tool starts 1 mm above the highest point, at x = 0, y = 0 mm"), std::string::npos)
      << over_upper;
  EXPECT_NE(over_upper.find("the mesh has 2 components; the tool has no room over the largest"), std::string::npos);
  EXPECT_NEAR(Json::parse(test::read_file(directory_ / "made.json"))["initial"]["position_m"][2].get<double>(), 0.0265,
              1e-6);
  EXPECT_EQ(outcome(), "completes");
  for (const char* kind : {"drag", "fidelity"}) {
    output_of(kind, balls);
    EXPECT_GE(start_gap(), 0.0005) << kind;
    EXPECT_EQ(outcome(), "completes") << kind;
  }
  // A plate with a post at +x: the path has another direction.
  const TriangleSoup plate = box({0, 0, -1}, {12, 12, 2});
  output_of("drag", test::together(plate, box({4, 0, 4}, {2, 3, 8})));
  EXPECT_NE(Json::parse(test::read_file(directory_ / "made.json"))["hand"]["direction"], (Json{1, 0, 0}));
  EXPECT_EQ(outcome(), "completes");
  // A plate under a roof: the tool starts on the roof, or with a warning under the roof if a point under it is given.
  const TriangleSoup roofed = test::together(plate, box({0, 0, 6}, {12, 12, 1}));
  output_of("drag", roofed);
  EXPECT_EQ(outcome(), "completes");
  const std::string under = output_of("drag", roofed, {"--at", "0,0,0"});
  EXPECT_NE(under.find("warning: the tool starts in contact: "), std::string::npos) << under;
  EXPECT_NE(under.find("choose another start with --at, --side or --path"), std::string::npos) << under;
}

TEST_F(NewStart, StartsFreeOfASteepSurface) {
  const TriangleSoup ball = test::sphere(10.0, 4);
  const std::string pressed = output_of("mesh", ball, {"--at", "0.0099,0,0"});
  EXPECT_NE(pressed.find("warning: --at 0.0099,0,0: a tool that starts 1 mm above this point touches the surface"),
            std::string::npos)
      << pressed;
  EXPECT_NE(pressed.find("choose another --at, or --side=x"), std::string::npos) << pressed;
  EXPECT_EQ(pressed.find("highest point"), std::string::npos) << pressed;
  EXPECT_NEAR(start_gap(), 0.001, 3e-5);
  const std::string dragged = output_of("drag", ball, {"--at", "0,0,-0.01"});
  EXPECT_NE(dragged.find("the surface at this point does not face side z"), std::string::npos) << dragged;
  EXPECT_NE(dragged.find("or --side=-z"), std::string::npos) << dragged;
  EXPECT_GE(start_gap(), 0.0005);
}

TEST_F(NewStart, WarnsAboutPointsFarFromTheSurface) {
  const std::string output = output_of("drag", test::sphere(10.0, 4), {"--path", "0,0,0", "--path", "0,0,0.0101"});
  EXPECT_NE(output.find("--path 0,0,0: the point is 9.9"), std::string::npos) << output;
  EXPECT_NE(output.find("give points on the surface"), std::string::npos) << output;
  EXPECT_EQ(output.find("--path 0,0,0.0101"), std::string::npos) << output;
}

TEST_F(NewStart, AdvisesCommandsThatItAccepts) {
  // The advised command keeps all options.
  test::write_plainly(directory_ / "my box.obj", test::obj_text(test::cube(5.0)));
  std::vector<std::string> drag = {"new",  "drag",       "--from", "my box.obj", "--side=-x",
                                   "--at", "-0.005,0,0", "--out",  "q.json",     "--quiet"};
  const ProgramRun refused = hapbench(drag, {.directory = directory_.path()});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("\"hapbench new drag --from 'my box.obj' --side=-x --at -0.005,0,0 --out q.json --quiet "
                             "--unit mm\""),
            std::string::npos)
      << refused.err;
  drag.insert(drag.end(), {"--unit", "mm"});
  EXPECT_EQ(hapbench(drag, {.directory = directory_.path()}).status, 0);
  test::write_plainly(directory_ / "stroke.csv",
                      "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n0,0,0,0.002,0,0,-1\n0.3,0,0,-0.002,0,0,-1\n");
  std::vector<std::string> words = {"new", "stroke", "--from", "stroke.csv", "--on", "my box.obj", "--out", "s.json"};
  EXPECT_NE(hapbench(words, {.directory = directory_.path()})
                .err.find("\"hapbench new stroke --from stroke.csv --on 'my box.obj' --out s.json --unit mm\""),
            std::string::npos);
  // A stroke inside the mesh: the warning names no option that is refused, and each warning is printed once.
  words.insert(words.end(), {"--unit", "mm"});
  const ProgramRun inside = hapbench(words, {.directory = directory_.path()});
  EXPECT_EQ(inside.status, 0) << inside.err;
  EXPECT_NE(inside.err.find("a run of this scene ends as"), std::string::npos) << inside.err;
  EXPECT_EQ(inside.err.find("--path"), std::string::npos) << inside.err;
  EXPECT_EQ(inside.err.find("--at"), std::string::npos) << inside.err;
  EXPECT_EQ(inside.err.find("the stroke has 2 samples"), inside.err.rfind("the stroke has 2 samples")) << inside.err;
}

TEST_F(NewOnASheet, PlaysAStrokeBackOverAMesh) {
  // Use a stroke along x, 0.1 mm below the top of the hump, in metres.
  test::write_plainly(
      directory_ / "stroke.csv",
      "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n0,-0.002,0,0.0009,0,0,-1\n1,0.002,0,0.0009,0,0,-1\n");
  const Json json = made({"stroke", "--from", path("stroke.csv"), "--on", path("up.obj"), "--extent", "8mm"});
  EXPECT_EQ(json["environment"]["type"], "mesh");
  EXPECT_EQ(json["environment"]["scale"], 0.001);
  EXPECT_EQ(json["motion"]["position"]["file"], "stroke.csv");
}

/// Returns the warnings of `validate` about mesh_molar, the bundled scene of a tooth 10 mm long, with these fields.
std::string warnings_of_tooth(std::vector<std::string> fields) {
  std::vector<std::string> words = {"validate", "mesh_molar"};
  for (const std::string& field : fields) words.insert(words.end(), {"--set", field});
  const ProgramRun run = test::hapbench_in_process(words);
  EXPECT_EQ(run.status, 0) << run.err;
  return run.err;
}

TEST(ValidateCommand, NamesASizeThatNoHandWorksOn) {
  const std::string size = "usual environments are 1 mm ... 1 m long: is environment.scale right?";
  // Check millimetres that are read as metres, with a tool of the same scale.
  const std::string large =
      warnings_of_tooth({"environment.scale=1", "environment.spacing_m=0.15", "tool.diameter_m=1", "tool.length_m=10"});
  EXPECT_NE(large.find(size), std::string::npos) << large;
  const std::string small = warnings_of_tooth(
      {"environment.scale=5e-5", "environment.spacing_m=1e-5", "tool.diameter_m=1e-4", "tool.length_m=1e-3"});
  EXPECT_NE(small.find(size), std::string::npos) << small;
}

TEST(ValidateCommand, NamesPointsThatTheToolFeelsOneByOne) {
  const std::string coarse = warnings_of_tooth({"environment.spacing_m=0.00017"});
  EXPECT_NE(coarse.find("the points are 0.17 mm apart, which a tool 1 mm wide feels as a rough surface; try --set "
                        "environment.spacing_m=0.0001\n"),
            std::string::npos)
      << coarse;
  EXPECT_EQ(warnings_of_tooth({"environment.spacing_m=0.00016"}).find("apart"), std::string::npos);
}

/// Checks that no bundled scene causes a warning about units, reversed normals or a coarse point spacing. In a bundled
/// scene, such a warning would be a false alarm.
TEST(ValidateCommand, FindsNoUnitsWrongInBundledScenes) {
  for (const test::NamedScenario& scenario : test::bundled_scenario_files()) {
    const ProgramRun run = test::hapbench_in_process({"validate", scenario.name});
    EXPECT_EQ(run.status, 0) << scenario.name << run.err;
    for (const char* words : {"in metres?", "in seconds?", "behind the surface", "right?", "rough surface"})
      EXPECT_EQ(run.err.find(words), std::string::npos) << scenario.name << run.err;
  }
}

class ShellCommand : public NewCommand {
 protected:
  std::vector<SurfacePoint> points_in(const std::string& name) const {
    return parse_point_shell(test::read_file(directory_ / name), directory_ / name);
  }
};

TEST_F(ShellCommand, WritesTheEnvironmentsPointsExactlyAsCsv) {
  const ProgramRun run = hapbench({"validate", "peg_in_hole_2d_mean", "--points", path("hole.csv")});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto points = points_in("hole.csv"), expected = surface_points(Hole2d{});
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].position, expected[i].position) << i;
    EXPECT_EQ(points[i].normal, expected[i].normal) << i;
  }
  EXPECT_NE(run.out.find("\n  points       written to " + path("hole.csv") + "\n"), std::string::npos) << run.out;
}

TEST_F(ShellCommand, WritesWhatARunReadsAsTheSameEnvironment) {
  // The hole, exported to a file, gives bitwise the same run.
  ASSERT_EQ(hapbench({"validate", "peg_in_hole_2d_mean", "--points", path("hole.csv")}).status, 0);
  ASSERT_EQ(hapbench({"run", "peg_in_hole_2d_mean", "--out", path("analytic")}).status, 0);
  // Only the environment changes: the effective scenario already has all other values that depend on its type.
  Json json = Json::parse(test::read_file(directory_ / "analytic/scenario.effective.json"));
  json["environment"] = {{"type", "point_shell"}, {"file", "hole.csv"}, {"grid_m", 0.0001}};
  test::write_plainly(directory_ / "scene.json", json.dump());
  ASSERT_EQ(hapbench({"run", path("scene.json"), "--out", path("file")}).status, 0);
  EXPECT_EQ(test::read_file(directory_ / "file/trajectory.csv"),
            test::read_file(directory_ / "analytic/trajectory.csv"));
  EXPECT_EQ(Json::parse(test::read_file(directory_ / "file/summary.json"))["state_hash"],
            Json::parse(test::read_file(directory_ / "analytic/summary.json"))["state_hash"]);
}

/// Returns the text without the files that its lines name before a JSON pointer.
std::string without_files(const std::string& text) {
  return std::regex_replace(text, std::regex("[^\n]*\\.json: /"), "/");
}

/// Checks that effective scenarios reproduce their runs. Runs scenarios with files, all records and unusual settings.
/// Then runs their effective scenarios in a directory that is reached by a symbolic link. The second runs write other
/// file paths into their effective scenarios. Everything else is the same, including the hash of the scenario.
TEST(EffectiveScenario, ReproducesTheRunFromAnotherDirectory) {
  const test::TemporaryDirectory directory;
  fs::create_directory(directory / "my scenes");
  for (const char* file : {"cube.obj", "shell.csv", "stroke.csv", "trace.csv"})
    fs::copy_file(test::data_directory() / file, directory.path() / "my scenes" / file);
  fs::create_directories(directory / "disk/deep/results");
  fs::create_directory_symlink(directory / "disk/deep/results", directory / "link");
  for (const auto& [name, json] : test::rich_scenarios()) {
    SCOPED_TRACE(name);
    const fs::path file = directory.path() / "my scenes" / (name + ".json"), first = directory.path() / "link" / name,
                   second = directory.path() / "b" / name;
    test::write_plainly(file, json.dump());
    const ProgramRun run = hapbench({"run", file.string(), "--out", first.string()});
    ASSERT_EQ(run.status, 0) << run.err;
    const ProgramRun again = hapbench({"run", (first / "scenario.effective.json").string(), "--out", second.string()});
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(without_files(again.err), without_files(run.err));  // warnings about the run
    test::expect_same_files(first, second, {"timing.json", "scenario.effective.json"});
  }
}

}  // namespace
}  // namespace hapbench::start_and_shell_test
