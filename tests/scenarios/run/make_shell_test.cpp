#include "scenarios/run/make_shell.hpp"

#include <gtest/gtest.h>

#include "sim/mesh/marching_cubes.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::make_shell_test {
namespace {

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
  // Those of cubes between multiples of the grid's spacing would be others.
  const auto& block = std::get<BlockEnvironment>(scenario.environment);
  const IsoSurface surface = marching_cubes(density_field(block.block, block.grid, block.density), {.cells = true});
  EXPECT_EQ(per_cell->cell_of_points(), points_by_cell(surface, block.grid).cells);
}

}  // namespace
}  // namespace hapbench::make_shell_test
