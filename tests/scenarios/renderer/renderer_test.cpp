// Tests hapbench_renderer.h: the errors of opening a renderer, and that its forces are bitwise equal to the forces of
// the engine.

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/registry.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/scenarios/renderer/haptic_loop.hpp"
#include "tests/scenarios/support/bundled.hpp"

namespace hapbench::renderer_test {
namespace {

std::string error_of(const HapbenchSetup& setup) {
  std::array<char, HAPBENCH_ERROR_SIZE> error{};
  const Opened renderer(hapbench_renderer_open(&setup, error.data()));
  EXPECT_EQ(renderer, nullptr);
  return error.data();
}

TEST(OpenRenderer, RefusesWhatItCannotRender) {
  const auto refused = [](const char* words, const auto& change) {
    HapbenchSetup setup = setup_of(kPlane);
    change(setup);
    const std::string error = error_of(setup);
    EXPECT_NE(error.find(words), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  };
  using Setup = HapbenchSetup;
  refused("version: got 2; allowed: 1", [](Setup& s) { s.version = 2; });
  refused("mode: got 3", [](Setup& s) { s.mode = 3; });
  refused("flags: got 8", [](Setup& s) { s.flags = 8; });
  refused("reserved: got 1", [](Setup& s) { s.reserved = 1; });
  refused("scenario: got NULL", [](Setup& s) { s.scenario = nullptr; });
  refused("drag_moler: no such file", [](Setup& s) { s.scenario = "drag_moler"; });
  refused("missing.json", [](Setup& s) { s.scenario = "/nowhere/missing.json"; });
  refused("extends", [](Setup& s) { s.scenario = R"({"extends": "drag_molar"})"; });
  refused("mount.max_force: got 0", [](Setup& s) { s.mount.max_force = 0; });
  refused("mount.max_force: got nan", [](Setup& s) { s.mount.max_force = kNaN; });
  refused("mount.max_force_rate", [](Setup& s) { s.mount.max_force_rate = -1; });
  refused("mount.scale", [](Setup& s) { s.mount.scale = 0; });
  refused("mount.scale", [](Setup& s) { s.mount.scale = INFINITY; });
  refused("mount.ramp_s", [](Setup& s) { s.mount.ramp_s = 61; });
  refused("mount.stale_s", [](Setup& s) { s.mount.stale_s = 0; });
  refused("mount.engage_force", [](Setup& s) { s.mount.engage_force = kNaN; });
  refused("mount.stale_s: got 0.001 s, but the period of the loop (time.step_s) is 0.001 s",
          [](Setup& s) { s.mount.stale_s = kPeriod; });
  static const char* const kSlow[] = {"time.step_s=0.02", nullptr};
  refused("allowed: > 0.02 s, such as 0.2 s, or a time.step_s < 0.01 s", [](Setup& s) { s.overrides = kSlow; });
  refused("mount.handle_from_tip.orientation", [](Setup& s) { s.mount.handle_from_tip.orientation[0] = 0; });
  refused("mount.world_from_device.position", [](Setup& s) { s.mount.world_from_device.position[1] = kNaN; });
  refused("/device/type", [](Setup& s) { s.mode = HAPBENCH_ADMITTANCE; });
  static const char* const kUnknown[] = {"rendering.stifness_N_per_m=1", nullptr};
  refused("stifness", [](Setup& s) { s.overrides = kUnknown; });
  static const char* const kModules[] = {HAPBENCH_TEST_MODULES "/hostile.so", nullptr};
  refused("HAPBENCH_ALLOW_MODULES", [](Setup& s) { s.modules = kModules; });
  static const char* const kPlugin[] = {
      "rendering.contact_source={\"type\": \"plugin\", \"file\": \"" HAPBENCH_TEST_MODULES "/sphere.so\"}", nullptr};
  refused("code would be executed", [](Setup& s) { s.overrides = kPlugin; });
  std::array<char, HAPBENCH_ERROR_SIZE> error{};
  EXPECT_EQ(hapbench_renderer_open(nullptr, error.data()), nullptr);
  EXPECT_NE(error[0], '\0');
}

TEST(OpenRenderer, ReportsWhatItUsesAndIgnores) {
  HapbenchSetup setup = setup_of(kPlane);
  static const char* const kOverrides[] = {"device.viscous_N_s_per_m=0.3", "time.step_s=0.002", nullptr};
  setup.overrides = kOverrides;
  const Opened renderer = opened(setup);
  const std::string text = hapbench_renderer_inspect(renderer.get());
  const std::string used = text.substr(text.find("used of the device:"), text.find("ignored") - text.find("used"));
  EXPECT_NE(used.find("device.force_max_N = 50"), std::string::npos) << text;
  EXPECT_NE(used.find("device.velocity_filter"), std::string::npos) << text;
  EXPECT_EQ(used.find("viscous"), std::string::npos) << text;
  EXPECT_NE(text.find("device.viscous_N_s_per_m", text.find("ignored")), std::string::npos) << text;
  EXPECT_EQ(hapbench_renderer_period(renderer.get()), 0.002);
}

TEST(OpenRenderer, RendersWithALongPeriodIfTheLongestTimeBetweenCallsIsLonger) {
  HapbenchSetup setup = setup_of(kPlane);
  static const char* const kSlow[] = {"time.step_s=0.02", nullptr};
  setup.overrides = kSlow;
  setup.mount.stale_s = 0.2;
  Loop loop(setup);
  HapbenchOutput output{};
  for (int i = 0; i < 50; ++i) output = loop.at(0.002, 0.02);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_ON));
  EXPECT_GT(loop.at(kInside, 0.02).force[2], 0.05);
}

/// Checks that a renderer gives the forces of a scripted run. Feeds the poses of the run to the renderer; once the gain
/// is 1, the forces must be bitwise equal.
void expect_forces_of(const Json& scene, const std::string& what) {
  const std::string text = scene.dump();
  const Scenario scenario = read_scenario(scene, ".").scenario;
  const std::vector<StepRecord> rows = test::rows_of(scenario);
  HapbenchSetup setup = setup_of(text.c_str());
  setup.mount.ramp_s = 0.0;
  Loop loop(setup);
  ASSERT_NE(loop.renderer, nullptr);
  loop.input.has = HAPBENCH_VELOCITY;
  std::size_t in_contact = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      loop.input.handle.position[i] = rows[k].tool.pose.position[i];
      loop.input.velocity[i] = rows[k].tool.velocity[i];
    }
    const HapbenchOutput output = loop.call(scenario.time.step);
    if (output.status == HAPBENCH_WAITING) {
      ASSERT_LT(k, 4u) << what;
      continue;
    }
    in_contact += rows[k].colliding > 0;
    for (int i = 0; i < 3; ++i)
      ASSERT_EQ(output.force[i], rows[k].force.rendered[i]) << what << ", step " << k << ", axis " << i;
  }
  EXPECT_GT(in_contact, 50u) << what;
}

TEST(Renderer, HasTheBitsOfTheEngineAlongAScript) {
  const std::vector<std::pair<const char*, const char*>> environments = {
      {"plane", R"({"type": "plane", "size_m": 0.004, "spacing_m": 0.0003})"},
      {"hole", R"({"type": "block_with_hole", "size_m": [0.004, 0.004, 0.004], "hole_diameter_m": 0.0015,
                   "hole_depth_m": 0.003, "grid_m": 0.0002})"}};
  for (const auto& [name, environment] : environments) {
    for (const std::string& algorithm : algorithm_names()) {
      Json scene = Json::parse(R"({
        "time": {"step_s": 0.001, "steps": 200},
        "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "round"},
        "motion": {"position": {"type": "prescribed",
          "x_m": {"type": "waypoints", "points": [[0, 0], [0.2, 0.0009]]}, "y_m": 0.0001,
          "z_m": {"type": "waypoints", "points": [[0, 0.0008], [0.02, 0.0006], [0.2, 0.0002]]}}},
        "rendering": {"damping_ratio": 0.3, "stiffness_N_per_m": 3000, "friction": {"type": "dry", "mu": 0.3}}
      })");
      scene["environment"] = Json::parse(environment);
      scene["rendering"]["algorithm"] = algorithm;
      expect_forces_of(scene, std::string(name) + ", " + algorithm);
    }
  }
}

TEST(Renderer, HasTheBitsOfTheEngineWithAVirtualMass) {
  // Use a hand that pushes down and sideways with more than the input-force limit, with every integrator.
  for (const IntegratorEntry* integrator : kIntegrators) {
    Json scene = Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 600},
      "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0003},
      "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "round"},
      "initial": {"position_m": [0, 0, 0.0006]},
      "hand": {"type": "force", "x_N": 0.05, "y_N": 0, "z_N": {"type": "waypoints", "points": [[0, -0.5], [0.1, -3]]}},
      "device": {"type": "ideal", "force_limit_N": 2},
      "rendering": {"algorithm": "shaped_stiffness", "stiffness_N_per_m": 5000, "damping_ratio": 0.7, "mass_kg": 0.2}
    })");
    scene["integrator"] = {{"type", integrator->info.name}};
    const std::string text = scene.dump();
    const std::vector<StepRecord> rows = test::rows_of(read_scenario(scene, ".").scenario);
    HapbenchSetup setup = setup_of(text.c_str());
    setup.mode = HAPBENCH_ADMITTANCE;
    setup.mount.ramp_s = 0.0;
    Loop loop(setup);
    ASSERT_NE(loop.renderer, nullptr);
    loop.input.has = HAPBENCH_HAND_FORCE;
    for (int i = 0; i < 3; ++i) loop.input.handle.position[i] = rows[0].tool.pose.position[i];
    std::size_t in_contact = 0, limited = 0;
    for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
      for (int i = 0; i < 3; ++i) loop.input.hand_force[i] = rows[k].hand_force[i];
      const HapbenchOutput output = loop.call(0.0005);
      in_contact += rows[k].colliding > 0;
      limited += (output.limited & HAPBENCH_INPUT_FORCE_LIMIT) != 0;
      for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(output.set_position[i], rows[k + 1].tool.pose.position[i]) << integrator->info.name << " " << k;
        ASSERT_EQ(output.set_velocity[i], rows[k + 1].tool.velocity[i]) << integrator->info.name << " " << k;
        if (output.status != HAPBENCH_WAITING) {
          ASSERT_EQ(output.force[i], rows[k].force.rendered[i]) << integrator->info.name << " " << k;
        }
      }
    }
    EXPECT_GT(in_contact, 100u);
    EXPECT_GT(limited, 100u);
  }
}

}  // namespace
}  // namespace hapbench::renderer_test
