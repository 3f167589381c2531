// Tests the lines with which `tune` describes how to open its scenario in a haptic loop. Also tests the overrides for a
// mount with another scale.

#include "scenarios/program/tune/loop_lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "device_model/live/hapbench_renderer.hpp"

namespace hapbench {
namespace {

// Scene of springs through the origin. At another scale, the same motion of the handle is a scaled motion in the same
// scene.
const char* const kScene = R"({
  "time": {"step_s": 0.001, "steps": 100},
  "environment": {"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 2},
                                                {"direction": [0, 0.6, 0.8], "count": 1}]},
  "device": {"type": "impedance", "handle_mass_kg": 0.05, "velocity_filter": {"type": "low_pass", "cutoff_Hz": 100}},
  "rendering": {"algorithm": "original_averaging", "stiffness_N_per_m": 2000, "damping_ratio": 0.2, "mass_kg": 0.1,
                "friction": {"mu_s_N_s_per_m": 0.5, "mu_f_s_per_m": 0.7}}
})";

/// Returns the forces [N] along a motion of the handle, three components per call.
std::vector<double> forces(double scale, const std::vector<std::string>& overrides) {
  HapbenchMount mount = HAPBENCH_MOUNT_INIT;
  mount.max_force = 100.0;
  mount.engage_force = 100.0;
  mount.scale = scale;
  Renderer renderer(kScene, mount, overrides);
  std::vector<double> found;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.001 * i;
    HapbenchInput input{};
    input.time_ns = 1'000'000u * static_cast<std::uint64_t>(i + 1);
    input.handle = {{0.003 * std::sin(9 * t), 0.002 * std::cos(7 * t), 0.001 * t}, {1, 0, 0, 0}};
    const HapbenchOutput output = renderer.step(input);
    found.insert(found.end(), output.force, output.force + 3);
  }
  return found;
}

TEST(LoopLines, GiveTheForceOfScaleOneAtEveryScale) {
  const std::vector<double> known = forces(1.0, {});
  const double largest = std::abs(*std::ranges::max_element(known, {}, [](double force) { return std::abs(force); }));
  ASSERT_GT(largest, 1.0);
  for (const double scale : {0.25, 2.0, 3.0}) {
    const std::vector<std::string> overrides = overrides_for_scale(Json::parse(kScene), scale);
    EXPECT_EQ(overrides.size(), 4u);  // stiffness, mass and both coefficients of friction
    const std::vector<double> scaled = forces(scale, overrides), plain = forces(scale, {});
    // Some hundred rounding errors of 1e-16 each, relative to the largest force.
    for (std::size_t i = 0; i < known.size(); ++i)
      EXPECT_NEAR(scaled[i], known[i], 1e-12 * largest) << scale << " " << i;
    EXPECT_NE(plain, known);
  }
  EXPECT_TRUE(overrides_for_scale(Json::parse(kScene), 1.0).empty());
}

TEST(LoopLines, AreStatementsInC) {
  const Json scene = Json::parse(kScene);
  EXPECT_EQ(loop_lines(scene, "out/my.json", 1.0),
            "for your own loop (scenarios/LOOP.md): setup.scenario = \"out/my.json\";\n");
  const std::string scaled = loop_lines(scene, "my.json", 2.0);
  for (const char* line : {"  setup.mount.scale = 2;\n", "      \"rendering.stiffness_N_per_m=1000\",\n",
                           "      \"rendering.mass_kg=0.05\",\n", "      NULL};\n  setup.overrides = overrides;\n"})
    EXPECT_NE(scaled.find(line), std::string::npos) << scaled;
}

}  // namespace
}  // namespace hapbench
