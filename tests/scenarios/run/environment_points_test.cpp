#include "scenarios/run/environment_points.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "scenarios/run/assemble.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// A small block, changed by a merge patch.
Scenario block_scenario(const char* patch = "{}") {
  Json json = Json::parse(R"({"time": {"step_s": 0.0005, "steps": 20}, "environment": {"type": "block_with_hole",
    "size_m": [0.006, 0.005, 0.004], "hole_diameter_m": 0.002, "hole_depth_m": 0.002, "grid_m": 0.0002}})");
  json.merge_patch(Json::parse(patch));
  return read_scenario(json, "").scenario;
}

std::string definition_of(const Scenario& scenario) {
  return shell_definition(scenario, NamedFiles(scenario));
}

bool same_bits(const std::vector<SurfacePoint>& a, const std::vector<SurfacePoint>& b) {
  return a.size() == b.size() &&
         std::memcmp(static_cast<const void*>(a.data()), b.data(), a.size() * sizeof(SurfacePoint)) == 0;
}

TEST(EnvironmentPoints, FromTheCacheAreThoseBuiltBitForBit) {
  const test::TemporaryDirectory directory;
  const ShellCache cache(directory.path());
  for (const char* patch :
       {"{}", R"({"environment": {"density": "binary"}})", R"({"environment": {"grid_m": 0.00015}})",
        R"({"environment": {"vertices": "per_cell"}})"}) {
    const Scenario scenario = block_scenario(patch);
    const EnvironmentPoints built = environment_points(scenario, ShellCache());
    const EnvironmentPoints first = environment_points(scenario, cache), second = environment_points(scenario, cache);
    EXPECT_FALSE(built.from_cache || first.from_cache) << patch;
    EXPECT_TRUE(second.from_cache) << patch;
    EXPECT_FALSE(built.points.empty());
    EXPECT_TRUE(same_bits(first.points, built.points)) << patch;
    EXPECT_TRUE(same_bits(second.points, built.points)) << patch;
    EXPECT_EQ(first.cells, built.cells) << patch;
    EXPECT_EQ(second.cells, built.cells) << patch;
  }
  EXPECT_EQ(cache.contents().shells, 4u);
}

TEST(EnvironmentPoints, OfABlockListVerticesOnceOrForEachCell) {
  const EnvironmentPoints shared = environment_points(block_scenario(), ShellCache());
  const Scenario scenario = block_scenario(R"({"environment": {"vertices": "per_cell"}})");
  const EnvironmentPoints per_cell = environment_points(scenario, ShellCache());
  EXPECT_TRUE(shared.cells.empty());
  EXPECT_EQ(per_cell.points.size(), 4 * shared.points.size());
  EXPECT_EQ(make_shell(scenario, per_cell)->cell_of_points(), per_cell.cells);
}

TEST(EnvironmentPoints, AreKeptOnlyWhereBuildingTakesLonger) {
  const test::TemporaryDirectory directory;
  for (const char* file : {"shell.csv", "cube.obj"}) {
    fs::copy_file(test::data_directory() / file, directory.path() / file);
  }
  const ShellCache cache(directory / "cache");
  for (const auto& [name, json] : test::minimal_scenarios()) {
    const Scenario scenario = read_scenario(json, directory.path()).scenario;
    environment_points(scenario, cache);
    EXPECT_EQ(environment_points(scenario, cache).from_cache, name == "block_with_hole" || name == "mesh") << name;
  }
}

TEST(ShellDefinition, DiffersWhenAnyFieldOfTheEnvironmentDiffers) {
  std::set<std::string> definitions = {definition_of(block_scenario())};
  const auto patches = {R"({"environment": {"size_m": [0.0060000000000000001, 0.005, 0.0041]}})",
                        R"({"environment": {"size_m": [0.006000000000000001, 0.005, 0.004]}})",
                        R"({"environment": {"hole_diameter_m": 0.0021}})",
                        R"({"environment": {"hole_depth_m": 0.0021}})",
                        R"({"environment": {"grid_m": 0.00020000000000000004}})",
                        R"({"environment": {"density": "binary"}})",
                        R"({"environment": {"vertices": "per_cell"}})"};
  for (const char* patch : patches) {
    EXPECT_TRUE(definitions.insert(definition_of(block_scenario(patch))).second) << patch;
  }
}

TEST(ShellDefinition, IsThatOfTheEnvironmentAlone) {
  const std::string definition = definition_of(block_scenario());
  for (const char* patch :
       {R"({"name": "b"})", R"({"seed": 2})", R"({"time": {"steps": 7}})", R"({"tool": {"diameter_m": 0.003}})",
        R"({"rendering": {"stiffness_N_per_m": 1}})", R"({"environment": {"density": "signed_distance"}})"}) {
    EXPECT_EQ(definition_of(block_scenario(patch)), definition) << patch;
  }
}

TEST(ShellDefinition, HoldsContentsNotPaths) {
  const test::TemporaryDirectory directory;
  const std::string shell = test::read_file(test::data_directory() / "shell.csv");
  for (const char* name : {"a.csv", "b.csv"}) test::write_plainly(directory / name, shell);
  test::write_plainly(directory / "c.csv", shell + "0,0,0,0,0,1\n");
  const auto definition_with = [&directory](const char* file) {
    Json json = test::minimal_scenario("point_shell");
    json["environment"]["file"] = file;
    return definition_of(read_scenario(json, directory.path()).scenario);
  };
  EXPECT_EQ(definition_with("b.csv"), definition_with("a.csv"));
  EXPECT_NE(definition_with("c.csv"), definition_with("a.csv"));
}

}  // namespace
}  // namespace hapbench
