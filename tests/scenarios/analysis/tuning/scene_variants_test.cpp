#include "scenarios/analysis/tuning/scene_variants.hpp"

#include <gtest/gtest.h>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench::family_test {
namespace {

TEST(Family, HastensScripts) {
  const LoadedScenario loaded = load_scenario(find_scenario("device_at_wall"));
  const auto speeds = scene_variants(loaded, "speeds");
  ASSERT_EQ(speeds.size(), 2u);
  const Scenario fast = load_scenario(read_scenario_text(loaded.file), speeds[1].overrides).scenario;
  EXPECT_EQ(fast.time.steps, loaded.scenario.time.steps / 2);
  const auto& slow_z = spring_of(loaded.scenario.hand)->target[2];
  const auto& fast_z = spring_of(fast.hand)->target[2];
  for (const double t : {0.0, 0.05, 0.2, 0.4}) EXPECT_DOUBLE_EQ(fast_z(t), slow_z(2.0 * t));
  EXPECT_EQ(scene_variants(loaded, "hands").size(), 2u);
  EXPECT_EQ(scene_variants(loaded, "seeds").size(), 4u);
  EXPECT_TRUE(scene_variants(load_scenario(find_scenario("single_spring")), "hands").empty());
}

}  // namespace
}  // namespace hapbench::family_test
