// Tests hapbench_renderer.h: errors of opening, bitwise equality with the engine, protection of the hand, wrong use,
// and the log.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cfenv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "algorithms/registry.hpp"
#include "device_model/live/hapbench_renderer.h"
#include "device_model/live/hapbench_renderer.hpp"
#include "results/summary/allocations.hpp"
#include "scenarios/renderer/loop_log.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/bundled.hpp"

namespace hapbench::renderer_test {
namespace {

constexpr double kPeriod = 0.001;  // [s]
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A plane at z = 0 below a round drill of 1 mm. Without damping, the force is a function of the position.
const char* const kPlane = R"({
  "name": "plane",
  "time": {"step_s": 0.001, "steps": 100},
  "environment": {"type": "plane", "size_m": 0.006, "spacing_m": 0.0005},
  "initial": {"position_m": [0, 0, 0.002]},
  "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "round"},
  "device": {"type": "impedance", "handle_mass_kg": 0.05, "force_max_N": 50},
  "rendering": {"algorithm": "mean", "stiffness_N_per_m": 2000, "damping_ratio": 0}
})";

struct Closed {
  void operator()(HapbenchRenderer* renderer) const { hapbench_renderer_close(renderer); }
};
using Opened = std::unique_ptr<HapbenchRenderer, Closed>;

HapbenchSetup setup_of(const char* scenario) {
  HapbenchSetup setup = HAPBENCH_SETUP_INIT;
  setup.scenario = scenario;
  setup.mount.max_force = INFINITY;
  setup.mount.ramp_s = 0.1;
  return setup;
}

Opened opened(const HapbenchSetup& setup) {
  std::array<char, HAPBENCH_ERROR_SIZE> error{};
  Opened renderer(hapbench_renderer_open(&setup, error.data()));
  EXPECT_NE(renderer, nullptr) << error.data();
  return renderer;
}

std::string error_of(const HapbenchSetup& setup) {
  std::array<char, HAPBENCH_ERROR_SIZE> error{};
  const Opened renderer(hapbench_renderer_open(&setup, error.data()));
  EXPECT_EQ(renderer, nullptr);
  return error.data();
}

/// A haptic loop with its own clock.
struct Loop {
  explicit Loop(const HapbenchSetup& setup) : renderer(opened(setup)) {
    input.time_ns = 1'000'000'000;
    input.handle = {{0, 0, 0.002}, {1, 0, 0, 0}};
  }
  /// Makes one call, `seconds` after the last call, at a height.
  HapbenchOutput at(double z, double seconds = kPeriod) {
    input.handle.position[2] = z;
    return call(seconds);
  }
  HapbenchOutput call(double seconds = kPeriod) {
    input.time_ns += static_cast<std::uint64_t>(std::llround(1e9 * seconds));
    HapbenchOutput output;
    const std::uint32_t status = hapbench_renderer_step(renderer.get(), &input, &output);
    EXPECT_EQ(status, output.status);
    return output;
  }
  /// Makes calls in free air until the gain of the force is 1.
  void engage() {
    HapbenchOutput output{};
    for (int i = 0; i < 200 && output.status != HAPBENCH_ON; ++i) output = at(0.002);
    ASSERT_EQ(output.status, static_cast<unsigned>(HAPBENCH_ON));
  }

  Opened renderer;
  HapbenchInput input{};
};

double norm(const double (&v)[3]) {
  return std::hypot(v[0], v[1], v[2]);
}

constexpr double kInside = 0.0003;  // height of the tip centre at which the drill is 0.2 mm deep [m]

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

/// Feeds the poses of a scripted run to a renderer. Once the gain is 1, the forces must be bitwise equal.
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
  // A hand pushes down and sideways with more than the input-force limit, with every integrator.
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

TEST(Renderer, WaitsForFourCallsAndRampsUp) {
  Loop loop(setup_of(kPlane));
  for (int i = 0; i < 4; ++i) {
    const HapbenchOutput output = loop.at(0.002);
    EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
    EXPECT_EQ(output.call, static_cast<std::uint64_t>(i));
  }
  // ramp_s is 0.1 s: the gain grows by 0.01 in each of 100 calls.
  double last = 0.0;
  for (int i = 1; i <= 100; ++i) {
    const HapbenchOutput output = loop.at(kInside);
    EXPECT_NEAR(output.gain, 0.01 * i, 1e-12);
    EXPECT_GE(output.force[2], last);
    last = output.force[2];
    EXPECT_EQ(output.status, i < 100 ? static_cast<unsigned>(HAPBENCH_RAMPING) : output.status);
  }
  const HapbenchOutput on = loop.at(kInside);
  EXPECT_EQ(on.status, static_cast<unsigned>(HAPBENCH_ON));
  EXPECT_GT(on.contacts, 0u);
  EXPECT_NEAR(on.dt, kPeriod, 1e-12);
  // Mean of penalty springs: at most K times the depth of the tip.
  EXPECT_GT(on.force[2], 0.05);
  EXPECT_LE(on.force[2], 2000 * 0.0002 + 1e-9);
}

TEST(Renderer, StartsInsideTheObjectWithoutForce) {
  Loop loop(setup_of(kPlane));
  for (int i = 0; i < 500; ++i) {
    const HapbenchOutput output = loop.at(-0.001);
    ASSERT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
    ASSERT_EQ(norm(output.force), 0.0);
    ASSERT_GT(output.contacts, 0u);
  }
  // Three calls outside are not enough; then the count starts again.
  for (int i = 0; i < 3; ++i) loop.at(0.002);
  EXPECT_EQ(loop.at(-0.001).status, static_cast<unsigned>(HAPBENCH_WAITING));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(loop.at(0.002).status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_EQ(loop.at(0.002).status, static_cast<unsigned>(HAPBENCH_RAMPING));
}

TEST(Renderer, LetsTheForceFallAfterAGap) {
  Loop loop(setup_of(kPlane));
  loop.engage();
  const double before = loop.at(kInside).force[2];
  ASSERT_GT(before, 0.05);
  // 50 ms of the ramp of 100 ms have passed, so half of the force is left, whatever the present pose is.
  const HapbenchOutput gap = loop.at(-0.003, 0.05);
  EXPECT_EQ(gap.status, static_cast<unsigned>(HAPBENCH_STALE));
  EXPECT_NEAR(gap.force[2], 0.5 * before, 1e-9);
  EXPECT_EQ(gap.contacts, 0u);
  HapbenchOutput output = gap;
  for (int i = 0; i < 50; ++i) {
    const double last = output.force[2];
    output = loop.at(-0.003);
    EXPECT_LE(output.force[2], last);
  }
  for (int i = 0; i < 10; ++i) output = loop.at(-0.003);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_EQ(norm(output.force), 0.0);
  // A gap longer than the ramp leaves no force at all.
  loop.engage();
  loop.at(kInside);
  const HapbenchOutput late = loop.at(-0.003, 2.0);
  EXPECT_EQ(late.status, static_cast<unsigned>(HAPBENCH_STALE));
  EXPECT_EQ(norm(late.force), 0.0);
  // 10 ms, the longest allowed time, is not a gap.
  loop.engage();
  EXPECT_EQ(loop.at(0.002, 0.01).status, static_cast<unsigned>(HAPBENCH_ON));
}

TEST(Renderer, LatchesAFaultUntilItIsRearmed) {
  const auto bad = [](auto change, std::uint32_t reason, const char* words) {
    Loop loop(setup_of(kPlane));
    loop.engage();
    const double before = loop.at(kInside).force[2];
    const HapbenchInput good = loop.input;
    change(loop.input);
    const HapbenchOutput fault = loop.call(reason == HAPBENCH_BAD_TIME ? 0.0 : kPeriod);
    EXPECT_EQ(fault.status, static_cast<unsigned>(HAPBENCH_FAULT)) << words;
    EXPECT_EQ(fault.reason, reason) << words;
    EXPECT_NE(std::string(hapbench_renderer_fault(loop.renderer.get())).find(words), std::string::npos)
        << hapbench_renderer_fault(loop.renderer.get());
    EXPECT_NEAR(fault.force[2], 0.99 * before, 1e-9) << words;  // 1 ms of a ramp of 100 ms
    const std::uint64_t time = std::max(loop.input.time_ns, good.time_ns);
    loop.input = good;
    loop.input.time_ns = time;
    HapbenchOutput output = fault;
    for (int i = 0; i < 300; ++i) output = loop.at(0.002);
    EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_FAULT)) << words;
    EXPECT_EQ(output.reason, reason);
    EXPECT_EQ(norm(output.force), 0.0);
    // A fault ends at the call in which the bit is set; a bit that stays set does not end a later fault.
    loop.input.has |= HAPBENCH_REARM;
    EXPECT_EQ(loop.at(0.002).status, static_cast<unsigned>(HAPBENCH_WAITING)) << words;
    loop.input.handle.position[0] = kNaN;
    EXPECT_EQ(loop.call().status, static_cast<unsigned>(HAPBENCH_FAULT));
    loop.input.handle.position[0] = 0.0;
    EXPECT_EQ(loop.call().status, static_cast<unsigned>(HAPBENCH_FAULT));
    loop.input.has &= ~static_cast<std::uint32_t>(HAPBENCH_REARM);
    loop.call();
    loop.input.has |= HAPBENCH_REARM;
    EXPECT_EQ(loop.call().status, static_cast<unsigned>(HAPBENCH_WAITING));
    loop.engage();
  };
  bad([](HapbenchInput& in) { in.handle.position[1] = kNaN; }, HAPBENCH_NOT_FINITE, "not finite");
  bad([](HapbenchInput& in) { in.handle.orientation[2] = kNaN; }, HAPBENCH_NOT_FINITE, "not finite");
  bad([](HapbenchInput& in) { in.has |= HAPBENCH_VELOCITY, in.velocity[0] = INFINITY; }, HAPBENCH_NOT_FINITE,
      "not finite");
  bad([](HapbenchInput& in) { in.has |= HAPBENCH_APPLIED_FORCE, in.applied_force[0] = kNaN; }, HAPBENCH_NOT_FINITE,
      "not finite");
  bad([](HapbenchInput& in) { in.handle.orientation[0] = 0.9; }, HAPBENCH_BAD_ORIENTATION, "orientation");
  bad([](HapbenchInput& in) { in.handle.orientation[0] = 0.0; }, HAPBENCH_BAD_ORIENTATION, "orientation");
  bad([](HapbenchInput& in) { in.has |= 64; }, HAPBENCH_BAD_BITS, "unknown bit");
  bad([](HapbenchInput& in) { in.reserved = 1; }, HAPBENCH_BAD_BITS, "reserved");
  bad([](HapbenchInput&) {}, HAPBENCH_BAD_TIME, "time_ns");
  bad([](HapbenchInput& in) { in.time_ns -= 1000; }, HAPBENCH_BAD_TIME, "time_ns");
  bad([](HapbenchInput& in) { in.handle.position[0] = 1e6; }, HAPBENCH_OUT_OF_BOUNDS, "position");
}

TEST(Renderer, DoesNotReadVectorsThatAreNotGiven) {
  Loop loop(setup_of(kPlane));
  for (auto* vector :
       {&loop.input.velocity, &loop.input.angular_velocity, &loop.input.hand_force, &loop.input.applied_force})
    std::fill_n(*vector, 3, kNaN);
  loop.engage();
  EXPECT_EQ(loop.at(kInside).status, static_cast<unsigned>(HAPBENCH_ON));
}

TEST(Renderer, RequiresTheVelocityWithoutAFilterAndTheForceOfTheHand) {
  static const char* const kIdeal[] = {"device={\"type\": \"ideal\"}", nullptr};
  HapbenchSetup setup = setup_of(kPlane);
  setup.overrides = kIdeal;
  Loop loop(setup);
  EXPECT_EQ(loop.at(0.002).reason, static_cast<unsigned>(HAPBENCH_NO_VELOCITY));
  setup.mode = HAPBENCH_ADMITTANCE;
  Loop admittance(setup);
  EXPECT_EQ(admittance.at(0.002).reason, static_cast<unsigned>(HAPBENCH_NO_HAND_FORCE));
}

TEST(Renderer, KeepsTheToolWhileTheClutchIsPressed) {
  Loop loop(setup_of(kPlane));
  loop.engage();
  const double before = loop.at(kInside).force[2];
  // The force falls within ramp_s, although the handle goes deeper.
  loop.input.has = HAPBENCH_CLUTCH;
  HapbenchOutput output = loop.at(-0.001);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_RAMPING));
  EXPECT_NEAR(output.force[2], 0.99 * before, 1e-9);
  for (int i = 0; i < 110; ++i) output = loop.at(0.0103);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_EQ(norm(output.force), 0.0);
  // After the release 10 mm higher, the tool is at its previous position: in contact, so the renderer waits.
  loop.input.has = 0;
  output = loop.at(0.01 + kInside);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_GT(output.contacts, 0u);
  // 2 mm above the plane in the moved frame, and back, gives the same force.
  for (int i = 0; i < 200; ++i) output = loop.at(0.012);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_ON));
  EXPECT_NEAR(loop.at(0.01 + kInside).force[2], before, 1e-6 * before);
}

TEST(Renderer, LimitsTheForceAndItsRate) {
  HapbenchSetup setup = setup_of(kPlane);
  setup.mount.max_force = 0.04;
  Loop loop(setup);
  loop.engage();
  HapbenchOutput output = loop.at(kInside);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_CLAMPED));
  EXPECT_EQ(output.limited, static_cast<unsigned>(HAPBENCH_MAX_FORCE));
  EXPECT_NEAR(norm(output.force), 0.04, 1e-15);
  setup.mount.max_force = INFINITY;
  setup.mount.max_force_rate = 10.0;  // 0.01 N a call
  Loop slow(setup);
  slow.engage();
  output = slow.at(kInside);
  EXPECT_EQ(output.limited, static_cast<unsigned>(HAPBENCH_MAX_FORCE_RATE));
  EXPECT_NEAR(norm(output.force), 0.01, 1e-12);
  // The smaller limit of mount and scenario holds: force_max_N is 50 N.
  EXPECT_NE(std::string(hapbench_renderer_inspect(slow.renderer.get())).find("largest force: 50 N"), std::string::npos);
}

TEST(Renderer, MountsTheDevice) {
  // The device's y axis is the world's z axis. 1 mm of the device is 2 mm of the world, 3 mm higher. The tip is 0.1 m
  // below the handle, along -y of the handle's frame.
  HapbenchSetup setup = setup_of(kPlane);
  setup.flags = HAPBENCH_TORQUE;
  const double s = std::sqrt(0.5);
  setup.mount.world_from_device = {{0, 0, 0.003}, {s, s, 0, 0}};  // 90 degrees about x: y -> z
  setup.mount.scale = 2.0;
  setup.mount.handle_from_tip = {{0, -0.1, 0}, {s, -s, 0, 0}};  // the tool points along -y of the handle
  Loop mounted(setup);
  HapbenchSetup plain_setup = setup_of(kPlane);
  Loop plain(plain_setup);
  plain.engage();
  const auto at = [&](double z) {
    mounted.input.handle.position[2] = 0.0;
    mounted.input.handle.position[1] = 0.1 + (z - 0.003) / 2.0;
    return mounted.call();
  };
  HapbenchOutput output{};
  for (int i = 0; i < 200; ++i) output = at(0.002);
  ASSERT_EQ(output.status, static_cast<unsigned>(HAPBENCH_ON));
  output = at(kInside);
  const HapbenchOutput expected = plain.at(kInside);
  EXPECT_EQ(output.contacts, expected.contacts);
  EXPECT_NEAR(output.force[1], expected.force[2], 1e-9);
  EXPECT_NEAR(output.force[0], 0.0, 1e-9);
  EXPECT_NEAR(output.force[2], 0.0, 1e-9);
  EXPECT_NEAR(norm(output.torque), 0.0, 1e-6);  // the force points along the arm
}

/// An admittance loop whose handle follows the set-points exactly; the tip is 0.1 m below the handle.
struct AdmittanceLoop : Loop {
  static HapbenchSetup setup() {
    static const char* const kOverrides[] = {R"(device={"type": "ideal"})", "rendering.mass_kg=0.1", nullptr};
    HapbenchSetup setup = setup_of(kPlane);
    setup.mode = HAPBENCH_ADMITTANCE;
    setup.overrides = kOverrides;
    setup.mount.handle_from_tip.position[2] = -0.1;
    return setup;
  }
  AdmittanceLoop() : Loop(setup()) {
    input.handle.position[2] = 0.102;
    input.has = HAPBENCH_HAND_FORCE;
  }
  HapbenchOutput pushed(double x, double z) {
    input.hand_force[0] = x;
    input.hand_force[2] = z;
    const HapbenchOutput output = call();
    if (output.status != HAPBENCH_FAULT) std::copy_n(output.set_position, 3, input.handle.position);
    return output;
  }
};

TEST(Renderer, HoldsTheSetPointDuringAFault) {
  AdmittanceLoop loop;
  HapbenchOutput output{};
  for (int i = 0; i < 150; ++i) output = loop.pushed(0.01, 0.0);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_ON));
  // A mass of 0.1 kg under 0.01 N: 0.1 m/s^2, after 150 periods of 1 ms 0.015 m/s.
  EXPECT_NEAR(output.set_velocity[0], 0.015, 1e-12);
  EXPECT_NEAR(output.set_position[2], 0.102, 1e-12);
  const HapbenchOutput last = output;
  loop.input.hand_force[1] = kNaN;
  output = loop.pushed(0.01, 0.0);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_FAULT));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(output.set_position[i], last.set_position[i]);
  EXPECT_EQ(norm(output.set_velocity), 0.0);
  // After rearming, the mass starts at rest at the handle.
  loop.input.hand_force[1] = 0.0;
  for (int i = 0; i < 110; ++i) loop.pushed(0.01, 0.0);
  loop.input.has |= HAPBENCH_REARM;
  loop.input.handle.position[0] = 0.05;
  output = loop.pushed(0.0, 0.0);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_NEAR(output.set_position[0], 0.05, 1e-12);
  EXPECT_EQ(norm(output.set_velocity), 0.0);
}

TEST(Renderer, MovesTheHandleOfAClutchedMassWithoutContact) {
  AdmittanceLoop loop;
  HapbenchOutput output{};
  // Push the tool onto the plane.
  for (int i = 0; i < 150; ++i) output = loop.pushed(0.0, 0.0);
  for (int i = 0; i < 3000 && output.contacts == 0; ++i) output = loop.pushed(0.0, -0.05);
  ASSERT_GT(output.contacts, 0u);
  const double touching = output.set_position[2];
  // While the clutch is pressed, the same push moves the handle further down, through the position of the plane.
  loop.input.has |= HAPBENCH_CLUTCH;
  for (int i = 0; i < 400; ++i) output = loop.pushed(0.0, -0.05);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_EQ(output.contacts, 0u);
  EXPECT_LT(output.set_position[2], touching - 0.005);
  // After the release, the set-point does not jump, and the tool is at the plane again.
  const HapbenchOutput clutched = output;
  loop.input.has = HAPBENCH_HAND_FORCE;
  output = loop.pushed(0.0, 0.0);
  EXPECT_NEAR(output.set_position[2], clutched.set_position[2] + kPeriod * clutched.set_velocity[2], 1e-9);
  EXPECT_GT(output.contacts, 0u);
}

TEST(Renderer, RefusesTheResultOfAFailingLaw) {
  HapbenchSetup setup = setup_of(kPlane);
  static const char* const kModules[] = {HAPBENCH_TEST_MODULES "/hostile.so", nullptr};
  static const char* const kOverrides[] = {"rendering.algorithm=hostile", nullptr};
  setup.modules = kModules;
  setup.overrides = kOverrides;
  setup.flags = HAPBENCH_ALLOW_MODULES;
  for (const char* failure : {"error", "nan"}) {
    Loop loop(setup);
    loop.engage();
    const double before = loop.at(kInside).force[2];
    setenv("HOSTILE", failure, 1);
    const AllocationCount allocations;
    const HapbenchOutput output = loop.at(kInside);
    EXPECT_EQ(allocations.value(), 0u);
    unsetenv("HOSTILE");
    EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_FAULT));
    EXPECT_EQ(output.reason, static_cast<unsigned>(HAPBENCH_ALGORITHM_FAILED));
    EXPECT_NEAR(output.force[2], 0.99 * before, 1e-9);
    EXPECT_NE(std::string(hapbench_renderer_fault(loop.renderer.get())).find("hostile"), std::string::npos);
    // After immediate rearming, the force continues to fall.
    loop.input.has = HAPBENCH_REARM;
    const HapbenchOutput rearmed = loop.at(0.002);
    EXPECT_EQ(rearmed.status, static_cast<unsigned>(HAPBENCH_RAMPING));
    EXPECT_NEAR(rearmed.force[2], 0.98 * before, 1e-9);
    for (int i = 0; i < 99; ++i) loop.at(0.002);
    EXPECT_EQ(loop.at(0.002).status, static_cast<unsigned>(HAPBENCH_WAITING));
  }
}

/// Returns inputs that touch, press, slide, clutch, cause faults and wait.
std::vector<HapbenchInput> busy_inputs(std::size_t n) {
  std::vector<HapbenchInput> inputs(n);
  for (std::size_t i = 0; i < n; ++i) {
    HapbenchInput& in = inputs[i];
    const double t = kPeriod * static_cast<double>(i);
    in.time_ns = 1'000'000'000 + i * 1'000'000 + (i >= n / 2 ? 50'000'000 : 0);
    in.handle = {{0.001 * std::sin(9.0 * t), 0.0005 * std::cos(7.0 * t), 0.0009 + 0.0008 * std::cos(11.0 * t)},
                 {std::cos(0.1 * t), std::sin(0.1 * t), 0.0, 0.0}};
    if (i % 3 == 0) in.has = HAPBENCH_VELOCITY, in.velocity[2] = -0.0088 * std::sin(11.0 * t);
    if (i > n / 4 && i < n / 3) in.has |= HAPBENCH_CLUTCH;
    if (i == 3 * n / 4) in.handle.position[0] = kNaN;
    if (i == 3 * n / 4 + 300) in.has |= HAPBENCH_REARM;
  }
  return inputs;
}

std::vector<HapbenchOutput> outputs_of(const HapbenchSetup& setup, const std::vector<HapbenchInput>& inputs) {
  const Opened renderer = opened(setup);
  std::vector<HapbenchOutput> outputs(inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) hapbench_renderer_step(renderer.get(), &inputs[i], &outputs[i]);
  return outputs;
}

TEST(Renderer, AllocatesNothingInACall) {
  const std::vector<HapbenchInput> inputs = busy_inputs(4000);
  for (const std::string& algorithm : algorithm_names()) {
    HapbenchSetup setup = setup_of(kPlane);
    setup.flags = HAPBENCH_TORQUE;
    const std::string override = "rendering.algorithm=" + algorithm;
    const char* const overrides[] = {override.c_str(), "rendering.damping_ratio=0.2",
                                     R"(rendering.friction={"type": "dry", "mu": 0.3})", nullptr};
    setup.overrides = overrides;
    const Opened renderer = opened(setup);
    std::array<std::size_t, 6> calls{};
    const AllocationCount allocations;
    HapbenchOutput output;
    for (const HapbenchInput& input : inputs) ++calls[hapbench_renderer_step(renderer.get(), &input, &output)];
    EXPECT_EQ(allocations.value(), 0u) << algorithm;
    for (const int status : {HAPBENCH_WAITING, HAPBENCH_RAMPING, HAPBENCH_ON, HAPBENCH_FAULT})
      EXPECT_GT(calls[static_cast<std::size_t>(status)], 0u) << algorithm << ", status " << status;
  }
}

TEST(Renderer, TwoInTwoThreadsDoNotDisturbEachOther) {
  const std::vector<HapbenchInput> inputs = busy_inputs(3000);
  const HapbenchSetup one = setup_of(kPlane);
  HapbenchSetup other = one;
  static const char* const kOther[] = {"rendering.algorithm=shaped_stiffness", "rendering.stiffness_N_per_m=900",
                                       nullptr};
  other.overrides = kOther;
  const auto alone = outputs_of(one, inputs), other_alone = outputs_of(other, inputs);
  std::vector<HapbenchOutput> together, other_together;
  {
    const std::jthread first([&] { together = outputs_of(one, inputs); });
    const std::jthread second([&] { other_together = outputs_of(other, inputs); });
  }
  EXPECT_EQ(compare_outputs(alone, together).equal, inputs.size());
  EXPECT_EQ(compare_outputs(other_alone, other_together).equal, inputs.size());
  EXPECT_GT(compare_outputs(alone, other_alone).largest, 0.01);
}

TEST(Renderer, SetsAndRestoresTheFloatingPointMode) {
  const std::vector<HapbenchInput> inputs = busy_inputs(500);
  const auto expected = outputs_of(setup_of(kPlane), inputs);
  std::fesetround(FE_UPWARD);
  const auto upward = outputs_of(setup_of(kPlane), inputs);
  const int rounding = std::fegetround();
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(rounding, FE_UPWARD);
  EXPECT_EQ(compare_outputs(expected, upward).equal, inputs.size());
}

TEST(Renderer, AnswersNullArguments) {
  HapbenchOutput output;
  HapbenchInput input{};
  EXPECT_EQ(hapbench_renderer_step(nullptr, &input, &output), static_cast<unsigned>(HAPBENCH_FAULT));
  EXPECT_EQ(output.reason, static_cast<unsigned>(HAPBENCH_NULL_ARGUMENT));
  EXPECT_EQ(norm(output.force), 0.0);
  EXPECT_EQ(hapbench_renderer_step(nullptr, nullptr, nullptr), static_cast<unsigned>(HAPBENCH_FAULT));
  hapbench_renderer_close(nullptr);
}

// The layout of version 1. A change of a size or an offset needs a new HAPBENCH_RENDERER_VERSION.
TEST(RendererAbi, IsThatOfVersion1) {
  static_assert(HAPBENCH_RENDERER_VERSION == 1);
  static_assert(sizeof(HapbenchPose3) == 56);
  static_assert(sizeof(HapbenchMount) == 160 && offsetof(HapbenchMount, scale) == 56 &&
                offsetof(HapbenchMount, handle_from_tip) == 64 && offsetof(HapbenchMount, max_force) == 120 &&
                offsetof(HapbenchMount, engage_force) == 152);
  static_assert(sizeof(HapbenchSetup) == 16 + 4 * sizeof(void*) + sizeof(HapbenchMount) &&
                offsetof(HapbenchSetup, scenario) == 16);
  static_assert(sizeof(HapbenchInput) == 168 && offsetof(HapbenchInput, handle) == 8 &&
                offsetof(HapbenchInput, velocity) == 64 && offsetof(HapbenchInput, has) == 160);
  static_assert(sizeof(HapbenchOutput) == 136 && offsetof(HapbenchOutput, set_position) == 48 &&
                offsetof(HapbenchOutput, gain) == 96 && offsetof(HapbenchOutput, call) == 112 &&
                offsetof(HapbenchOutput, limited) == 132);
  EXPECT_EQ(HAPBENCH_FAULT, 5);
  EXPECT_EQ(HAPBENCH_REARM, 32);
}

std::string log_of(const HapbenchSetup& setup, const std::vector<HapbenchInput>& inputs) {
  const Opened renderer = opened(setup);
  std::string text(hapbench_renderer_log_header(renderer.get(), nullptr, 0) + 1, '\0');
  text.resize(hapbench_renderer_log_header(renderer.get(), text.data(), text.size()));
  for (const HapbenchInput& input : inputs) {
    HapbenchOutput output;
    hapbench_renderer_step(renderer.get(), &input, &output);
    std::array<char, HAPBENCH_LOG_ROW_SIZE> row{};
    EXPECT_GT(hapbench_renderer_log_row(&input, &output, row.data(), row.size()), 0u);
    text += row.data();
  }
  return text;
}

TEST(LoopLog, IsReplayedBitForBit) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "loop.csv";
  const std::vector<HapbenchInput> inputs = busy_inputs(4000);
  const std::string text = log_of(setup_of(kPlane), inputs);
  test::write_plainly(file, text);
  const LoopLog log = read_loop_log(file);
  ASSERT_EQ(log.inputs.size(), inputs.size());
  HapbenchSetup setup = setup_of(kPlane);
  EXPECT_EQ(log.setup.mount.max_force, setup.mount.max_force);
  const Opened renderer = opened(setup);
  const std::vector<HapbenchOutput> again = replayed(*renderer, log);
  const ReplayComparison compared = compare_outputs(again, log.outputs);
  EXPECT_EQ(compared.equal, inputs.size()) << "first other: " << compared.first_other;
  // A change of a recorded digit is detected.
  LoopLog changed = log;
  changed.outputs[100].force[2] = std::nextafter(changed.outputs[100].force[2], 1.0);
  EXPECT_EQ(compare_outputs(again, changed.outputs).first_other, 100u);
}

TEST(LoopLog, RefusesWhatIsNotAWholeLog) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "loop.csv";
  const std::string text = log_of(setup_of(kPlane), busy_inputs(10));
  std::vector<std::string> lines = test::lines_of(text);
  const auto error_with = [&](std::vector<std::string> changed) {
    std::string all;
    for (const std::string& line : changed) all += line + "\n";
    test::write_plainly(file, all);
    try {
      read_loop_log(file);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing is refused");
  };
  EXPECT_EQ(error_with(lines), "nothing is refused");
  // Any line ends, and a byte order mark.
  for (const std::string end : {"\r\n", "\r"}) {
    std::string other = "\xEF\xBB\xBF";
    for (const std::string& line : lines) other += line + end;
    test::write_plainly(file, other);
    EXPECT_EQ(read_loop_log(file).inputs.size(), 10u);
  }
  auto missing = lines;
  missing.erase(missing.begin() + 6);
  EXPECT_NE(error_with(missing).find("line 7: got call 5 where call 4"), std::string::npos) << error_with(missing);
  auto short_row = lines;
  short_row.back().resize(short_row.back().size() / 2);
  EXPECT_NE(error_with(short_row).find("line 12"), std::string::npos) << error_with(short_row);
  auto text_cell = lines;
  text_cell[5].replace(0, 1, "x");
  EXPECT_NE(error_with(text_cell).find("allowed: a number"), std::string::npos) << error_with(text_cell);
  EXPECT_NE(error_with({"a,b", "1,2"}).find("is not a log"), std::string::npos);
  EXPECT_NE(error_with({lines[0], lines[1]}).find("no calls"), std::string::npos);
}

TEST(RendererInCpp, IsThinOnTheCInterface) {
  HapbenchMount mount = HAPBENCH_MOUNT_INIT;
  EXPECT_THROW(Renderer(kPlane, mount), std::runtime_error);
  mount.max_force = 3.0;
  Renderer renderer(kPlane, mount, {"time.step_s=0.002"});
  EXPECT_EQ(renderer.period(), 0.002);
  HapbenchInput input{};
  input.handle = {{0, 0, 0.002}, {1, 0, 0, 0}};
  const HapbenchOutput output = renderer.step(input);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_NE(renderer.log_header().find("\"period_s\":0.002"), std::string::npos);
  EXPECT_EQ(Renderer::log_row(input, output).back(), '\n');
}

}  // namespace
}  // namespace hapbench::renderer_test
