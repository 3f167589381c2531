#include "scenarios/run/environment_points.hpp"

#include <gtest/gtest.h>

#include "scenarios/run/assemble.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::environment_points_test {
namespace {

/// A small block, changed by a merge patch.
Scenario block_scenario(const char* patch = "{}") {
  Json json = Json::parse(R"({"time": {"step_s": 0.0005, "steps": 20}, "environment": {"type": "block_with_hole",
    "size_m": [0.006, 0.005, 0.004], "hole_diameter_m": 0.002, "hole_depth_m": 0.002, "grid_m": 0.0002}})");
  json.merge_patch(Json::parse(patch));
  return read_scenario(json, "").scenario;
}

TEST(EnvironmentPoints, OfABlockListVerticesOnceOrForEachCell) {
  const ShellPoints shared = environment_points(block_scenario());
  const Scenario scenario = block_scenario(R"({"environment": {"vertices": "per_cell"}})");
  const ShellPoints per_cell = environment_points(scenario);
  EXPECT_TRUE(shared.cells.empty());
  EXPECT_EQ(per_cell.points.size(), 4 * shared.points.size());
  EXPECT_EQ(make_shell(scenario, per_cell)->cell_of_points(), per_cell.cells);
}

}  // namespace
}  // namespace hapbench::environment_points_test
