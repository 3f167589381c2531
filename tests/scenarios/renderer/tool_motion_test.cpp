// Tests how the renderer gets the motion of the tool from its input: the angular velocity and the position filter.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/scenarios/renderer/haptic_loop.hpp"

namespace hapbench::renderer_test {
namespace {

/// Rotates the handle about the x axis by `angle` [rad].
void set_angle(Loop& loop, double angle) {
  double(&orientation)[4] = loop.input.handle.orientation;
  orientation[0] = std::cos(0.5 * angle);
  orientation[1] = std::sin(0.5 * angle);
}

/// Returns a setup in which friction depends on the velocity of the tool's material, without a low-pass of the angular
/// velocity.
HapbenchSetup setup_with_angular_damping() {
  static const char* const kOverrides[] = {"rendering.angular_damping=true",
                                           "rendering.angular_velocity_cutoff_Hz=null", nullptr};
  HapbenchSetup setup = setup_of(kPlane);
  setup.overrides = kOverrides;
  return setup;
}

TEST(Renderer, ComputesTheAngularVelocityThatIsNotGiven) {
  constexpr double kRate = 2.0;  // [rad/s]
  const HapbenchSetup setup = setup_with_angular_damping();
  Loop computed(setup), given(setup), still(setup);
  given.input.has = still.input.has = HAPBENCH_ANGULAR_VELOCITY;
  given.input.angular_velocity[0] = kRate;
  for (Loop* loop : {&computed, &given, &still}) loop->engage();
  for (int k = 1; k <= 5; ++k) {
    for (Loop* loop : {&computed, &given, &still}) set_angle(*loop, kRate * kPeriod * k);
    const HapbenchOutput a = computed.at(kInside), b = given.at(kInside), c = still.at(kInside);
    // The first call in contact moves the tool down by 1.7 mm: its friction has no simple value.
    if (k == 1) continue;
    // The force is about 0.2 N. The turn of a step, 0.002 rad, is a difference of directions of length 1, with an error
    // of 1e-16, so that the angular velocity has a relative error of 1e-13.
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a.force[i], b.force[i], 1e-12) << "call " << k << ", axis " << i;
    // A contact lies about 0.4 mm below the tip centre. With 2 rad/s, the material moves there with 0.8 mm/s, and the
    // friction of at least 5 N s/m is 4 mN. Without a given rotation there is no friction.
    EXPECT_NEAR(c.force[1], 0.0, 1e-12);
    EXPECT_LT(a.force[1], -0.002);
  }
}

TEST(Renderer, FiltersTheMeasuredPosition) {
  constexpr double kCutoff = 30.0;  // [Hz]
  static const char* const kOverrides[] = {"device.position_filter={\"cutoff_Hz\": 30}", nullptr};
  HapbenchSetup setup = setup_of(kPlane);
  Loop plain(setup);
  setup.overrides = kOverrides;
  Loop filtered(setup);
  plain.engage();
  filtered.engage();
  // The filter starts at the first measured position. In kPlane, the force depends on the position only.
  const double share = -std::expm1(-2.0 * std::numbers::pi * kCutoff * kPeriod);
  double height = 0.002;
  for (int k = 0; k < 40; ++k) {
    height += share * (kInside - height);
    const HapbenchOutput a = filtered.at(kInside), b = plain.at(height);
    EXPECT_EQ(a.contacts, b.contacts) << k;
    // K is 2000 N/m, and the filtered position has an error of some 1e-18 m.
    EXPECT_NEAR(a.force[2], b.force[2], 1e-12) << k;
  }
  EXPECT_GT(plain.at(height).force[2], 0.3);
}

}  // namespace
}  // namespace hapbench::renderer_test
