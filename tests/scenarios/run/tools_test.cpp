#include <gtest/gtest.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenarios/format/load_scenario.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "sim/mesh/marching_cubes.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// Tools and environments of every type, from the fields of a scenario.
namespace hapbench::tools_test {
namespace {

/// A plane that the tool is pressed on.
Json scene(const std::string& tool, const std::string& algorithm = "shaped_stiffness") {
  Json json = test::minimal_scenario("plane");
  json["time"]["steps"] = 200;
  json["tool"] = Json::parse(tool);
  json["hand"] = {{"type", "force"}, {"z_N", -1}};
  json["rendering"]["algorithm"] = algorithm;
  return json;
}

LoadedScenario loaded(const Json& json) {
  return read_scenario(json, test::data_directory());
}

std::shared_ptr<const ToolShape> tool_of(const std::string& fields) {
  const LoadedScenario scenario = loaded(scene(fields));
  return make_tool(scenario.scenario, scenario.files);
}

const std::string kCube = R"({"type": "mesh", "file": "cube.obj", "scale": 0.0001, "tip_m": [0.0, 0.0, 0.0],
                               "tip_axis": [0.0, 0.0, -1.0], "grid_m": 0.00005})";
const std::string kHourglass =
    R"({"type": "revolved", "profile_m": [[-0.01, 0.002], [-0.002, 0.0003], [0, 0.001]], "tip": "flat"})";

TEST(ScenarioTool, WithoutATypeIsTheCylinderOfThatType) {
  for (const char* fields :
       {R"({"diameter_m": 0.002, "tip": "round"})", R"({"type": "cylinder", "diameter_m": 0.002, "tip": "round"})"}) {
    const Json json = scene(fields);
    EXPECT_EQ(effective_scenario(loaded(json).scenario, "")["tool"],
              Json::parse(R"({"diameter_m": 0.002, "length_m": 0.01, "tip": "round"})"));
    EXPECT_EQ(tool_of(fields)->half_width(), 0.001);
  }
}

/// The tool's frame at its tip, on whichever face of the cube that is; with it the box lies behind the tip centre.
TEST(ScenarioTool, OfAMeshHasItsTipWhereItsFieldsSay) {
  for (const auto& [place, axis] : {std::pair{"[0.0005, 0, 0]", "[2, 0, 0]"},
                                    {"[0, -0.0005, 0]", "[0, -1, 0]"},
                                    {"[0, 0, 0.0005]", "[0, 0, 1]"},
                                    {"[0, 0, -0.0005]", "[0, 0, -1]"}}) {
    const auto tool = tool_of(fmt::format(
        R"({{"type": "mesh", "file": "cube.obj", "scale": 0.0001, "tip_m": {}, "tip_axis": {}, "grid_m": 0.00005}})",
        place, axis));
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    for (const Vec3& vertex : dynamic_cast<const MeshTool&>(*tool).grid().vertices()) {
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
    // Rounding of places of 1 mm by a turn: some units in the last place, 2e-19.
    EXPECT_LT((low - Vec3(-0.0005, -0.0005, 0.0)).norm(), 1e-18) << axis << ": " << low.transpose();
    EXPECT_LT((high - Vec3(0.0005, 0.0005, 0.001)).norm(), 1e-18) << axis << ": " << high.transpose();
  }
}

TEST(ScenarioTool, ThatLiesOddlyInItsFrameIsNamed) {
  const Vec3 wide(0.001, 0.001, 0.0), low(0, 0, 0.009);
  EXPECT_EQ(odd_frame({-wide, wide + low}), "");
  EXPECT_EQ(odd_frame({-wide - low, wide}), "lies before its tip centre, not behind");
  EXPECT_EQ(odd_frame({Vec3(0, -0.001, -0.001), Vec3(0.009, 0.001, 0.001)}), "lies across its axis");
  EXPECT_EQ(odd_frame({wide + low, 2.0 * wide + 2.0 * low}), "lies 9.11 mm away from its tip centre");
  // A wheel is wider than it is long on purpose.
  EXPECT_EQ(odd_frame({Vec3(-0.002, -0.002, 0), Vec3(0.002, 0.002, 0.0005)}), "");
}

TEST(ScenarioTool, HasAnOutlineFromTheFarEndToTheTipThatIsAsLargeAsItIs) {
  for (const std::string& fields : {std::string(R"({"tip": "round"})"), std::string("{}"), kCube, kHourglass,
                                    std::string(R"({"type": "bur", "family": "pear", "diameter_m": 0.001})")}) {
    const auto tool = tool_of(fields);
    const std::vector<ProfilePoint> outline = tool->outline();
    ASSERT_GE(outline.size(), 4u) << fields;
    EXPECT_EQ(outline.front().rho, 0.0) << fields;
    EXPECT_EQ(outline.back().rho, 0.0) << fields;
    EXPECT_LT(outline.front().s, outline.back().s) << fields;
    double reach = 0.0;
    for (const ProfilePoint& point : outline) reach = std::max(reach, std::hypot(point.s, point.rho));
    EXPECT_NEAR(reach, tool->reach(), fields == kCube ? 0.00005 : 1e-12) << fields;
  }
}

TEST(ScenarioTool, WarnsThatTheProxyHasNoGuaranteeWhereItIsNotConvex) {
  for (const auto& [fields, algorithm, warnings] :
       {std::tuple{kHourglass, "proxy", 1}, std::tuple{kHourglass, "mean", 0}, std::tuple{kCube, "proxy", 0}}) {
    const Result report = run_scenario(loaded(scene(fields, algorithm)), std::nullopt, false);
    const auto about_that = [](const Warning& w) { return w.text.starts_with("the tool is not convex"); };
    EXPECT_EQ(std::ranges::count_if(report.warnings, about_that), warnings) << fields << " " << algorithm;
  }
}

TEST(ScenarioTool, IsInTheSummaryUnlessItIsACylinder) {
  EXPECT_FALSE(run_scenario(loaded(scene("{}")), std::nullopt, false).tool);
  const auto tool = run_scenario(loaded(scene(kHourglass)), std::nullopt, false).tool;
  ASSERT_TRUE(tool);
  EXPECT_EQ(tool->outline, tool_of(kHourglass)->outline());
  EXPECT_EQ(tool->reach, tool_of(kHourglass)->reach());
}

/// A small block, changed by a merge patch.
Scenario block_scenario(const char* patch = "{}") {
  Json json = Json::parse(R"({"time": {"step_s": 0.0005, "steps": 20}, "environment": {"type": "block_with_hole",
    "size_m": [0.006, 0.005, 0.004], "hole_diameter_m": 0.002, "hole_depth_m": 0.002, "grid_m": 0.0002}})");
  json.merge_patch(Json::parse(patch));
  return read_scenario(json, "").scenario;
}

TEST(MakeShell, OfABlockListsVerticesOnceOrForEachCell) {
  const auto shared = make_shell(block_scenario());
  const Scenario scenario = block_scenario(R"({"environment": {"vertices": "per_cell"}})");
  const auto per_cell = make_shell(scenario);
  EXPECT_GT(shared->size(), 1000u);
  EXPECT_EQ(per_cell->size(), 4 * shared->size());
  // Cubes between multiples of the grid's spacing would give other cells.
  const auto& block = std::get<BlockEnvironment>(scenario.environment);
  const IsoSurface surface = marching_cubes(density_field(block.block, block.grid, block.density), {.cells = true});
  EXPECT_EQ(per_cell->cell_of_points(), points_by_cell(surface, block.grid).cells);
}

}  // namespace
}  // namespace hapbench::tools_test
