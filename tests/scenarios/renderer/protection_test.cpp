// Tests the protection of the hand by hapbench_renderer.h: start without force, too long times between calls, faults,
// clutch, limits of the force, mounts of the device, and failing laws.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "results/summary/allocations.hpp"
#include "tests/scenarios/renderer/haptic_loop.hpp"

namespace hapbench::renderer_test {
namespace {

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
  // The law is the mean of the penalty springs, so the force is at most K times the depth of the tip.
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
  // The force begins to rise after four successive calls in free air. Three such calls are not enough: the contact
  // after them restarts the count.
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
  // 50 ms of the ramp of 100 ms have passed, so half of the force remains, whatever the current pose is.
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
  // If the time between two calls is longer than the ramp that fades the force out, no force is left.
  loop.engage();
  loop.at(kInside);
  const HapbenchOutput late = loop.at(-0.003, 2.0);
  EXPECT_EQ(late.status, static_cast<unsigned>(HAPBENCH_STALE));
  EXPECT_EQ(norm(late.force), 0.0);
  // 10 ms is the longest allowed time between two calls, so it is not a gap.
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
    // Setting the bit HAPBENCH_REARM ends a fault in the same call. If the bit stays set, it does not end a later
    // fault.
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
  // The clutch is released 10 mm higher. The tool is still where it was when the clutch was pressed: in contact, so the
  // renderer waits.
  loop.input.has = 0;
  output = loop.at(0.01 + kInside);
  EXPECT_EQ(output.status, static_cast<unsigned>(HAPBENCH_WAITING));
  EXPECT_GT(output.contacts, 0u);
  // The clutch has shifted the device's frame by 10 mm. After the tool moves to 2 mm above the plane and back, the
  // force is the same as before the clutch.
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
  setup.mount.max_force_rate = 10.0;  // 0.01 N per call
  Loop slow(setup);
  slow.engage();
  output = slow.at(kInside);
  EXPECT_EQ(output.limited, static_cast<unsigned>(HAPBENCH_MAX_FORCE_RATE));
  EXPECT_NEAR(norm(output.force), 0.01, 1e-12);
  // The smaller of the two limits applies. Here it is force_max_N of the scenario, 50 N.
  EXPECT_NE(std::string(hapbench_renderer_inspect(slow.renderer.get())).find("largest force: 50 N"), std::string::npos);
}

TEST(Renderer, MountsTheDevice) {
  // The device's y axis is the world's z axis. The origin of the device's frame is 3 mm above the origin of the world.
  // A displacement of the device by 1 mm is 2 mm in the world. The tip is 0.1 m below the handle, along -y of the
  // handle's frame.
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

/// An admittance loop whose handle follows the set-points exactly. The tip is 0.1 m below the handle.
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
  // A force of 0.01 N on a mass of 0.1 kg gives 0.1 m/s^2, and 0.015 m/s after 150 periods of 1 ms.
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
  // When the clutch is released, the set-point does not jump, and the tool is again in contact with the plane.
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
    // The force continues to fall although the renderer is rearmed at once.
    loop.input.has = HAPBENCH_REARM;
    const HapbenchOutput rearmed = loop.at(0.002);
    EXPECT_EQ(rearmed.status, static_cast<unsigned>(HAPBENCH_RAMPING));
    EXPECT_NEAR(rearmed.force[2], 0.98 * before, 1e-9);
    for (int i = 0; i < 99; ++i) loop.at(0.002);
    EXPECT_EQ(loop.at(0.002).status, static_cast<unsigned>(HAPBENCH_WAITING));
  }
}

}  // namespace
}  // namespace hapbench::renderer_test
