#include "device_model/handle_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/core/random.hpp"

namespace hapbench::handle_motion_test {
namespace {

constexpr double kMass = 0.2, kCoulomb = 0.5, kSpeed = 0.3;

/// A handle that starts with this velocity at the origin, with a hand that does nothing.
HandleMotion started(const HandleMotionConfig& config, const Vec3& velocity, const AttachedHand& hand = {}) {
  HandleMotion motion(config, hand);
  motion.reset({Vec3::Zero(), velocity});
  return motion;
}

void advance(HandleMotion& motion, const Vec3& force, double time) {
  motion.advance(force, free_motion(motion.law(), time));
}

TEST(HandleMotion, StopsWhereAndWhenCoulombFrictionSays) {
  const double stop = kMass * kSpeed / kCoulomb, place = 0.5 * kMass * kSpeed * kSpeed / kCoulomb;
  HandleMotion motion = started({kMass, 0.0, kCoulomb}, {kSpeed, -kSpeed, 0.0});
  advance(motion, Vec3::Zero(), 0.999 * stop);
  EXPECT_NEAR(motion.handle().velocity.x(), 0.001 * kSpeed, 1e-15);
  EXPECT_NEAR(motion.handle().velocity.y(), -0.001 * kSpeed, 1e-15);
  advance(motion, Vec3::Zero(), 0.002 * stop);
  EXPECT_EQ(motion.handle().velocity, Vec3(0, 0, 0));
  EXPECT_NEAR(motion.handle().position.x(), place, 1e-16);
  EXPECT_NEAR(motion.handle().position.y(), -place, 1e-16);
}

TEST(HandleMotion, StopsWithViscousFrictionToo) {
  constexpr double b = 2.0;
  const double log = std::log1p(b * kSpeed / kCoulomb), stop = kMass / b * log;
  HandleMotion motion = started({kMass, b, kCoulomb}, {kSpeed, 0, 0});
  advance(motion, Vec3::Zero(), stop * (1.0 - 1e-6));
  EXPECT_GT(motion.handle().velocity.x(), 0.0);
  advance(motion, Vec3::Zero(), stop * 2e-6);
  EXPECT_EQ(motion.handle().velocity.x(), 0.0);
  EXPECT_NEAR(motion.handle().position.x(), kMass / b * (kSpeed - kCoulomb / b * log), 1e-15);
}

TEST(HandleMotion, SticksUpToTheFrictionAndBreaksAwayBeyond) {
  HandleMotion motion = started({kMass, 0.0, kCoulomb}, Vec3::Zero());
  advance(motion, {kCoulomb, -kCoulomb, 0.999 * kCoulomb}, 1.0);
  EXPECT_EQ(motion.handle().position, Vec3(0, 0, 0));
  EXPECT_EQ(motion.handle().velocity, Vec3(0, 0, 0));
  const double push = 1.25 * kCoulomb, time = 0.25;
  advance(motion, {push, -push, 0.0}, time);
  const double place = 0.5 * (push - kCoulomb) / kMass * time * time;
  EXPECT_NEAR(motion.handle().position.x(), place, 1e-15);
  EXPECT_NEAR(motion.handle().position.y(), -place, 1e-15);
  EXPECT_EQ(motion.handle().position.z(), 0.0);
}

TEST(HandleMotion, TurnsRoundWithinAStretch) {
  HandleMotion motion = started({kMass, 0.0, kCoulomb}, {kSpeed, 0, 0});
  const double force = -2.0;
  const double stop = kMass * kSpeed / (kCoulomb - force), place = 0.5 * kSpeed * stop;
  const double after = 0.1, back = (force + kCoulomb) / kMass;  // friction points the other way now
  advance(motion, {force, 0, 0}, stop + after);
  EXPECT_NEAR(motion.handle().velocity.x(), back * after, 1e-14);
  EXPECT_NEAR(motion.handle().position.x(), place + 0.5 * back * after * after, 1e-15);
}

/// A mass on a spring with dry friction loses 2 c / k of amplitude with each half swing, and stays where the spring is
/// weaker than the friction: all of it in one stretch.
TEST(HandleMotion, SwingsOutUnderAHandWithASpring) {
  constexpr double k = 100.0, kStart = 0.0987;
  HandleMotion motion({kMass, 0.0, kCoulomb}, {0.1, k, 0.0});
  motion.reset({Vec3(kStart, 0, -kStart), Vec3::Zero()});
  motion.take_hand({-k * kStart, 0, k * kStart});  // towards the origin
  advance(motion, Vec3::Zero(), 100.0);
  double amplitude = kStart;
  int swings = 0;
  for (; k * amplitude > kCoulomb; ++swings) amplitude -= 2.0 * kCoulomb / k;
  ASSERT_GE(swings, 9);
  const double place = swings % 2 == 0 ? amplitude : -amplitude;
  EXPECT_EQ(motion.handle().velocity, Vec3(0, 0, 0));
  EXPECT_NEAR(motion.handle().position.x(), place, 1e-13);
  EXPECT_NEAR(motion.handle().position.z(), -place, 1e-13);
  EXPECT_EQ(motion.handle().position.y(), 0.0);
}

/// Friction of rest never makes a stuck handle shake, whatever the hand's spring does with a tiny push.
TEST(HandleMotion, DoesNotChatter) {
  HandleMotion motion = started({kMass, 0.3, kCoulomb}, {kSpeed, 0, 0}, {0.1, 300.0, 6.0});
  bool stuck = false;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 before = motion.handle().position;
    motion.take_hand(-300.0 * motion.handle().position - 6.0 * motion.handle().velocity);
    advance(motion, Vec3::Zero(), 0.001);
    if (stuck) {
      EXPECT_EQ(motion.handle().position, before);
    }
    if (motion.handle().velocity.x() != 0.0) continue;
    stuck = true;
    EXPECT_LE(std::abs(300.0 * motion.handle().position.x()), kCoulomb);
  }
  EXPECT_TRUE(stuck);
}

/// Two axes at once against many small steps of a fourth-order method, without Coulomb friction.
TEST(HandleMotion, MovesWithAHandThatIsFixedToItAsOneBody) {
  const HandleMotionConfig config{kMass, 1.5, 0.0};
  const AttachedHand hand{0.3, 500.0, 8.0};
  const Vec3 target(0.01, -0.02, 0.0), target_velocity(0.1, 0, 0), motors(1.0, 2.0, 0.0);
  HandleMotion motion(config, hand);
  motion.reset({Vec3(0.002, 0, 0), Vec3(-0.1, 0.2, 0)});
  const auto& h = motion.handle();
  motion.take_hand(hand.stiffness * (target - h.position) + hand.damping * (target_velocity - h.velocity));
  Vec3 x = h.position, v = h.velocity;
  const auto acceleration = [&](const Vec3& at, const Vec3& speed) {
    const Vec3 push = hand.stiffness * (target - at) + hand.damping * (target_velocity - speed);
    return Vec3((motors - config.viscous * speed + push) / (config.mass + hand.mass));
  };
  constexpr int kParts = 1000;
  constexpr double kTime = 0.05, h4 = kTime / kParts;
  for (int i = 0; i < kParts; ++i) {
    const Vec3 a1 = acceleration(x, v), v2 = v + 0.5 * h4 * a1, a2 = acceleration(x + 0.5 * h4 * v, v2);
    const Vec3 v3 = v + 0.5 * h4 * a2, a3 = acceleration(x + 0.5 * h4 * v2, v3);
    const Vec3 v4 = v + h4 * a3, a4 = acceleration(x + h4 * v3, v4);
    x += h4 / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += h4 / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  advance(motion, motors, kTime / 4);
  advance(motion, motors, 3 * kTime / 4);
  // The reference is off by about (w h)^5 a step, w = 35 / s: 1e-13 of its motion.
  EXPECT_LE((motion.handle().position - x).norm(), 1e-13);
  EXPECT_LE((motion.handle().velocity - v).norm(), 1e-11);
}

TEST(HandleMotion, KeepsItsEnergyBalanceToRounding) {
  Random random(3);
  for (const double coulomb : {0.0, 0.2}) {
    for (const AttachedHand& hand : {AttachedHand{}, AttachedHand{0.3, 500.0, 8.0}}) {
      HandleMotion motion = started({kMass, 1.5, coulomb}, {kSpeed, 0, 0}, hand);
      double turnover = 0.5 * kMass * kSpeed * kSpeed;
      for (int i = 0; i < 2000; ++i) {
        motion.take_hand({random.normal(), random.normal(), random.normal()});
        advance(motion, {2.0 * random.normal(), random.normal(), 0.0}, 0.001 * random.uniform());
        const DeviceEnergy e = motion.energy();
        turnover += std::abs(e.stored);
        // A step rounds each of a dozen terms of the size of the energy that moves.
        EXPECT_NEAR(e.stored, e.hand + e.actuator + e.dissipated, 1e-14 * turnover) << i;
      }
      EXPECT_LT(motion.energy().dissipated, 0.0);
    }
  }
}

/// Against the path and the speed themselves, which the balance does not use.
TEST(HandleMotion, DissipatesByItsFrictionAlone) {
  constexpr double b = 2.0;
  HandleMotion motion = started({kMass, b, kCoulomb}, {kSpeed, 0, 0});
  double viscous = 0.0, path = 0.0, speed = kSpeed;
  for (int i = 0; i < 20000; ++i) {  // halfway a force turns it round
    const double before = motion.handle().position.x();
    advance(motion, {i < 10000 ? 0.0 : -1.0, 0, 0}, 1e-5);
    const double way = motion.handle().position.x() - before, mean = 0.5 * (speed + motion.handle().velocity.x());
    speed = motion.handle().velocity.x();
    viscous += b * mean * mean * 1e-5;
    path += std::abs(way);
  }
  // The trapezoid is off by (h / time constant)^2, 1e-8.
  EXPECT_NEAR(motion.energy().dissipated, -viscous - kCoulomb * path, 1e-7 * (viscous + kCoulomb * path));
}

}  // namespace
}  // namespace hapbench::handle_motion_test
