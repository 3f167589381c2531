#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

#include "device_model/live/hapbench_renderer.h"

/// Renderers and haptic loops for the tests of hapbench_renderer.h.
namespace hapbench::renderer_test {

inline constexpr double kPeriod = 0.001;  ///< period of the loop [s]
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Scenario of a round drill, 1 mm in diameter, above the plane z = 0. Damping is zero, so the force depends only on
/// the position.
inline const char* const kPlane = R"({
  "name": "plane",
  "time": {"step_s": 0.001, "steps": 100},
  "environment": {"type": "plane", "size_m": 0.006, "spacing_m": 0.0005},
  "initial": {"position_m": [0, 0, 0.002]},
  "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "round"},
  "device": {"type": "impedance", "handle_mass_kg": 0.05, "force_max_N": 50},
  "rendering": {"algorithm": "mean", "stiffness_N_per_m": 2000, "damping_ratio": 0}
})";

/// Closes a renderer when its owning pointer is destroyed.
struct Closed {
  void operator()(HapbenchRenderer* renderer) const { hapbench_renderer_close(renderer); }
};
using Opened = std::unique_ptr<HapbenchRenderer, Closed>;

/// Returns a setup without a force limit and with a ramp of 0.1 s.
inline HapbenchSetup setup_of(const char* scenario) {
  HapbenchSetup setup = HAPBENCH_SETUP_INIT;
  setup.scenario = scenario;
  setup.mount.max_force = INFINITY;
  setup.mount.ramp_s = 0.1;
  return setup;
}

/// Opens a renderer. Fails the test if it cannot be opened.
inline Opened opened(const HapbenchSetup& setup) {
  std::array<char, HAPBENCH_ERROR_SIZE> error{};
  Opened renderer(hapbench_renderer_open(&setup, error.data()));
  EXPECT_NE(renderer, nullptr) << error.data();
  return renderer;
}

/// A haptic loop whose times are simulated: the test chooses the time between two calls of the renderer.
struct Loop {
  explicit Loop(const HapbenchSetup& setup) : renderer(opened(setup)) {
    input.time_ns = 1'000'000'000;
    input.handle = {{0, 0, 0.002}, {1, 0, 0, 0}};
  }
  /// Calls the renderer with the handle at the height z [m], `seconds` after the previous call, and returns its output.
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
  /// Calls the renderer with the handle in free air until its status is HAPBENCH_ON. Fails the test after 200 calls.
  void engage() {
    HapbenchOutput output{};
    for (int i = 0; i < 200 && output.status != HAPBENCH_ON; ++i) output = at(0.002);
    ASSERT_EQ(output.status, static_cast<unsigned>(HAPBENCH_ON));
  }

  Opened renderer;
  HapbenchInput input{};
};

inline double norm(const double (&v)[3]) {
  return std::hypot(v[0], v[1], v[2]);
}

/// Height of the tip centre [m] at which the lowest point of the drill is 0.2 mm below the plane.
inline constexpr double kInside = 0.0003;

}  // namespace hapbench::renderer_test
