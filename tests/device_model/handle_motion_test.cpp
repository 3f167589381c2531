#include "device_model/handle_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "device_model/impedance_device.hpp"
#include "sim/core/random.hpp"

namespace hapbench::handle_motion_test {
namespace {

using Complex = std::complex<long double>;

/// Position and velocity by the two exponentials, in complex long doubles.
struct Reference {
  MotionLaw law;

  long double position(long double v, long double g, long double t) const {
    const auto [l1, l2] = exponents();
    const Complex rest = g / static_cast<long double>(law.stiffness);
    const Complex c1 = (Complex(v) + l2 * rest) / (l1 - l2);
    return (rest + c1 * std::exp(l1 * t) - (rest + c1) * std::exp(l2 * t)).real();
  }
  long double velocity(long double v, long double g, long double t) const {
    const auto [l1, l2] = exponents();
    const Complex rest = g / static_cast<long double>(law.stiffness);
    const Complex c1 = (Complex(v) + l2 * rest) / (l1 - l2);
    return (l1 * c1 * std::exp(l1 * t) - l2 * (rest + c1) * std::exp(l2 * t)).real();
  }
  std::pair<Complex, Complex> exponents() const {
    const long double a = law.damping / 2.0L;
    const Complex d = std::sqrt(Complex(a * a - static_cast<long double>(law.stiffness)));
    return {-a + d, -a - d};
  }
};

const MotionLaw kSwings[] = {{0.0, 3000.0}, {5.0, 3000.0}, {300.0, 3000.0}, {2000.0, 3000.0}, {0.1, 1e6}};

TEST(FreeMotion, IsTheSumOfTwoExponentials) {
  for (const MotionLaw& law : kSwings) {
    const Reference reference{law};
    for (const double t : {1e-4, 1e-3, 0.01, 0.3}) {
      const FreeMotion m = free_motion(law, t);
      // The long double reference loses digits if the exponents are close.
      const double rate = 1.0 + law.damping + std::sqrt(law.stiffness);
      EXPECT_NEAR(m.S, static_cast<double>(reference.position(1, 0, t)), 1e-13 * t) << law.damping << " " << t;
      EXPECT_NEAR(m.V, static_cast<double>(reference.velocity(1, 0, t)), 1e-13 * (1 + rate * t)) << t;
      EXPECT_NEAR(m.P, static_cast<double>(reference.position(0, 1, t)), 1e-13 * t * t) << t;
      EXPECT_NEAR(m.S, static_cast<double>(reference.velocity(0, 1, t)), 1e-13 * t) << t;
    }
  }
}

TEST(FreeMotion, WithoutASpringIsTheOneOfAFrictionalMass) {
  for (const double k : {1e-9, 1e-3, 1.0, 100.0, 1e6}) {
    for (const double t : {1e-4, 1e-3, 0.1}) {
      const FreeMotion m = free_motion({k, 0.0}, t);
      const double S = -std::expm1(-k * t) / k;
      EXPECT_NEAR(m.S, S, 1e-14 * t + 1e-13 * S);
      EXPECT_NEAR(m.V, std::exp(-k * t), 1e-13);
      // (t - S) / k, or its series where the difference cancels.
      const double z = k * t, P = z < 1e-4 ? t * t * (0.5 - z / 6.0 + z * z / 24.0) : (t - S) / k;
      EXPECT_NEAR(m.P, P, (z < 1e-4 ? 1e-14 : 1e-12) * P / std::min(1.0, z < 1e-4 ? 1.0 : z));
    }
  }
  const FreeMotion free = free_motion({}, 0.5);
  EXPECT_EQ(free.S, 0.5);
  EXPECT_EQ(free.P, 0.125);
  EXPECT_EQ(free.V, 1.0);
}

/// Compared with Simpson's rule, whose error is (rate h)^4 / 180 = 1e-12 for the highest rate, 600 / s.
TEST(FreeMotion, IntegratesTheSquareOfTheVelocity) {
  for (const MotionLaw& law : {MotionLaw{0.0, 3000.0}, MotionLaw{300.0, 3000.0}, MotionLaw{40.0, 0.0}, MotionLaw{}}) {
    for (const auto& [v, g] : {std::pair{1.0, 0.0}, {0.0, 100.0}, {-0.7, 55.0}}) {
      constexpr double kTime = 0.05;
      constexpr int kParts = 8000;
      double sum = 0.0;
      for (int i = 0; i <= kParts; ++i) {
        const FreeMotion m = free_motion(law, kTime * i / kParts);
        const double velocity = v * m.V + g * m.S;
        sum += velocity * velocity * (i == 0 || i == kParts ? 1.0 : i % 2 == 0 ? 2.0 : 4.0);
      }
      sum *= kTime / kParts / 3.0;
      const FreeMotion m = free_motion(law, kTime);
      EXPECT_NEAR(v * v * m.W + v * g * m.S * m.S + g * g * m.Z, sum, 1e-10 * (1e-3 + sum)) << law.damping;
    }
  }
}

TEST(FreeMotion, StaysFiniteAndAtRestWhereEverythingIsOver) {
  const FreeMotion m = free_motion({1e15, 1e15}, 1.0);
  EXPECT_NEAR(m.V, 0.0, 1e-15);
  EXPECT_NEAR(m.S, 0.0, 1e-14);
  EXPECT_TRUE(std::isfinite(m.W) && std::isfinite(m.Z) && std::isfinite(m.P));
  EXPECT_EQ(free_motion({10.0, 10.0}, 0.0).V, 1.0);
  EXPECT_EQ(free_motion({10.0, 10.0}, 0.0).P, 0.0);
}

TEST(TimeOfRest, IsWhereTheVelocityIsZeroForTheFirstTime) {
  std::vector<MotionLaw> laws(std::begin(kSwings), std::end(kSwings));
  laws.insert(laws.end(), {{}, {1e-7, 0.0}, {20.0, 0.0}, {20.0, 100.0}});  // the last one critical
  for (const MotionLaw& law : laws) {
    for (const auto& [v, g] : {std::pair{0.1, -3.0}, {-0.1, 3.0}, {1e-9, -3.0}, {0.1, 3.0}, {-2.0, 0.3}}) {
      const double t = time_of_rest(law, v, g);
      ASSERT_GT(t, 0.0);
      const double scale = std::abs(v) + std::abs(g) * 0.01;
      if (std::isfinite(t)) {
        const FreeMotion m = free_motion(law, t);
        EXPECT_NEAR(v * m.V + g * m.S, 0.0, 1e-13 * scale) << law.damping << " " << law.stiffness << " " << v;
      }
      const double end = std::min(t, 1.0);
      for (int i = 1; i < 50; ++i) {
        const FreeMotion m = free_motion(law, end * i / 50);
        EXPECT_GT(std::copysign(1.0, v) * (v * m.V + g * m.S), -1e-13 * scale) << i;
      }
    }
  }
  EXPECT_EQ(time_of_rest({20.0, 0.0}, 0.1, 3.0), std::numeric_limits<double>::infinity()) << "it accelerates";
  EXPECT_NEAR(time_of_rest({0.0, 100.0}, 0.0, 1.0), 0.31415926535897931, 1e-15) << "half a swing";
}

constexpr double kMass = 0.2, kCoulomb = 0.5, kSpeed = 0.3;

ImpedanceDeviceConfig handle_of(double viscous, double coulomb) {
  ImpedanceDeviceConfig config;
  config.handle_mass = kMass;
  config.viscous = viscous;
  config.coulomb = coulomb;
  return config;
}

/// A handle that starts with this velocity at the origin, with a hand that exerts no force.
HandleMotion started(const ImpedanceDeviceConfig& config, const Vec3& velocity, const AttachedHand& hand = {}) {
  HandleMotion motion(config, hand);
  motion.reset({Vec3::Zero(), velocity});
  return motion;
}

void advance(HandleMotion& motion, const Vec3& force, double time) {
  motion.advance(force, free_motion(motion.law(), time));
}

TEST(HandleMotion, StopsWhereAndWhenCoulombFrictionSays) {
  const double stop = kMass * kSpeed / kCoulomb, place = 0.5 * kMass * kSpeed * kSpeed / kCoulomb;
  HandleMotion motion = started(handle_of(0.0, kCoulomb), {kSpeed, -kSpeed, 0.0});
  advance(motion, Vec3::Zero(), 0.999 * stop);
  EXPECT_NEAR(motion.handle().velocity.x(), 0.001 * kSpeed, 1e-15);
  EXPECT_NEAR(motion.handle().velocity.y(), -0.001 * kSpeed, 1e-15);
  advance(motion, Vec3::Zero(), 0.002 * stop);
  EXPECT_EQ(motion.handle().velocity, Vec3(0, 0, 0));
  EXPECT_NEAR(motion.handle().position.x(), place, 1e-16);
  EXPECT_NEAR(motion.handle().position.y(), -place, 1e-16);
}

TEST(HandleMotion, SticksUpToTheFrictionAndBreaksAwayBeyond) {
  HandleMotion motion = started(handle_of(0.0, kCoulomb), Vec3::Zero());
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

/// A mass on a spring with dry friction loses an amplitude of 2 c / k in each half period and stops where the spring is
/// weaker than the friction. One call covers the whole motion.
TEST(HandleMotion, SwingsOutUnderAHandWithASpring) {
  constexpr double k = 100.0, kStart = 0.0987;
  HandleMotion motion(handle_of(0.0, kCoulomb), {0.1, k, 0.0});
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

/// A handle that sticks stays at rest although the spring of the hand pushes it.
TEST(HandleMotion, DoesNotChatter) {
  HandleMotion motion = started(handle_of(0.3, kCoulomb), {kSpeed, 0, 0}, {0.1, 300.0, 6.0});
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

TEST(HandleMotion, KeepsItsEnergyBalanceToRounding) {
  Random random(3);
  for (const double coulomb : {0.0, 0.2}) {
    for (const AttachedHand& hand : {AttachedHand{}, AttachedHand{0.3, 500.0, 8.0}}) {
      HandleMotion motion = started(handle_of(1.5, coulomb), {kSpeed, 0, 0}, hand);
      double turnover = 0.5 * kMass * kSpeed * kSpeed;
      for (int i = 0; i < 2000; ++i) {
        motion.take_hand({random.normal(), random.normal(), random.normal()});
        advance(motion, {2.0 * random.normal(), random.normal(), 0.0}, 0.001 * random.uniform());
        const DeviceEnergy e = motion.energy();
        turnover += std::abs(e.stored);
        // Each step rounds a dozen terms of the size of the exchanged energy.
        EXPECT_NEAR(e.stored, e.hand + e.actuator + e.dissipated, 1e-14 * turnover) << i;
      }
      EXPECT_LT(motion.energy().dissipated, 0.0);
    }
  }
}

/// Compared with path and speed, which the energy balance does not use.
TEST(HandleMotion, DissipatesByItsFrictionAlone) {
  constexpr double b = 2.0;
  HandleMotion motion = started(handle_of(b, kCoulomb), {kSpeed, 0, 0});
  double viscous = 0.0, path = 0.0, speed = kSpeed;
  for (int i = 0; i < 20000; ++i) {  // halfway, a force reverses it
    const double before = motion.handle().position.x();
    advance(motion, {i < 10000 ? 0.0 : -1.0, 0, 0}, 1e-5);
    const double way = motion.handle().position.x() - before, mean = 0.5 * (speed + motion.handle().velocity.x());
    speed = motion.handle().velocity.x();
    viscous += b * mean * mean * 1e-5;
    path += std::abs(way);
  }
  // The trapezoidal rule has an error of (h / time constant)^2 = 1e-8.
  EXPECT_NEAR(motion.energy().dissipated, -viscous - kCoulomb * path, 1e-7 * (viscous + kCoulomb * path));
}

}  // namespace
}  // namespace hapbench::handle_motion_test
