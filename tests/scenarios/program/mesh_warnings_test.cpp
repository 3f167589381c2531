#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/meshes.hpp"

/// What is odd about a mesh is told once, by every command that reads it, and does not stop it.
namespace hapbench::mesh_warnings_test {
namespace {

using test::hapbench;

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

}  // namespace
}  // namespace hapbench::mesh_warnings_test
