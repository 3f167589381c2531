#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "device_model/handle_motion.hpp"
#include "device_model/impedance_device.hpp"
#include "sim/core/random.hpp"

namespace hapbench::handle_motion_test {
namespace {

// Compares the motion of motors and handle, which an elastic transmission connects, with closed forms and an
// independent integrator.

constexpr double kT = 0.001;

/// Returns a device with 0.06 kg of motors and a 0.04 kg handle.
ImpedanceDeviceConfig elastic_device(double stiffness, double damping) {
  ImpedanceDeviceConfig config;
  config.handle_mass = 0.1;
  config.transmission = Transmission{0.6, stiffness, damping};
  return config;
}

ElasticMotion motion_of(const ImpedanceDeviceConfig& config, const AttachedHand& hand = {}) {
  return {config, *config.transmission, hand};
}

/// Checks the motion without damping: the centre of mass moves like a body of 0.1 kg, and the stretch s = x_m - x_h
/// oscillates about f / (m_m w^2) with w^2 = k (1 / m_m + 1 / m_h).
TEST(ElasticMotion, SwingsAsTheNormalModesDo) {
  constexpr double k = 5000.0, f = 2.0, v0 = 0.3;
  const double w = std::sqrt(k * (1.0 / 0.06 + 1.0 / 0.04)), rest = f / (0.06 * w * w);
  ElasticMotion motion = motion_of(elastic_device(k, 0.0));
  for (const double time : {1e-4, kT, 0.05}) {
    const ElasticMotion::Stretch stretch = motion.stretch(time);
    motion.reset({{1.0, 0, 0}, {v0, 0, 0}});
    motion.advance({f, 0, 0}, stretch);
    const double centre = 1.0 + v0 * time + 0.5 * f / 0.1 * time * time, s = rest * (1.0 - std::cos(w * time));
    // Doubling an interval of a quarter radian n times multiplies its rounding error by 2^n = 4 w t.
    EXPECT_NEAR(motion.motor().position.x(), centre + 0.4 * s, 1e-14) << time;
    EXPECT_NEAR(motion.handle().position.x(), centre - 0.6 * s, 1e-14) << time;
    EXPECT_NEAR(motion.motor().velocity.x() - motion.handle().velocity.x(), rest * w * std::sin(w * time), 1e-13);
  }
}

/// Checks when sticking motors start to move. A push F on a handle of 0.04 kg loads the spring with F (1 - cos(w t)),
/// w^2 = k / m_h. The motors start to move when this force reaches the friction c.
TEST(ElasticMotion, StickingMotorsBreakLooseWhereTheClosedFormSays) {
  constexpr double k = 4000.0, kPush = 0.5, c = 0.7;
  ImpedanceDeviceConfig config = elastic_device(k, 0.0);
  config.coulomb = c;
  const double w = std::sqrt(k / 0.04), loose = std::acos(1.0 - c / kPush) / w;
  for (const double after : {-1e-9, 1e-9, 1e-4}) {
    ElasticMotion motion = motion_of(config);
    motion.reset({});
    motion.set_hand_force({kPush, 0, 0});
    const double time = loose + after;
    motion.advance(Vec3::Zero(), motion.stretch(time));
    const double swung = kPush / k * (1.0 - std::cos(w * loose)), speed = kPush * w / k * std::sin(w * loose);
    if (after < 0.0) {
      EXPECT_EQ(motion.motor().position.x(), 0.0);
      EXPECT_NEAR(motion.handle().position.x(), swung + speed * after, 1e-15);
      continue;
    }
    // Let t = `after` be the time since the motors have started to move, and `speed` the speed of the handle at the
    // start. At the time t, the force of the spring has grown by k speed t. Therefore the motors have the speed v_m = k
    // speed t^2 / (2 m_m). The relative error of this formula is (w t)^2 / 12.
    const double v = 0.5 * k * speed * after * after / 0.06;
    EXPECT_NEAR(motion.motor().velocity.x(), v, (after < 1e-6 ? 1e-3 : 0.02) * v) << after;
  }
}

struct Rates {
  double v_m, a_m, v_h, a_h;
};

/// Simulates motors and handle by the classical Runge-Kutta method with steps of `h`; stops and starts are rounded to
/// whole steps.
struct FineRun {
  ImpedanceDeviceConfig device;
  AttachedHand hand;
  double h;
  double x_m = 0.0, v_m = 0.0, x_h = 0.0, v_h = 0.0;

  void advance(double motors, double push, double origin, int steps) {
    const auto& [share, k, d] = *device.transmission;
    const double m_m = share * device.handle_mass, m_h = device.handle_mass - m_m + hand.mass;
    for (int i = 0; i < steps; ++i) {
      const double at_rest = motors - k * (x_m - x_h) + d * v_h;
      const bool sticks = v_m == 0.0 && std::abs(at_rest) <= device.coulomb;
      const double friction = std::copysign(device.coulomb, v_m == 0.0 ? -at_rest : -v_m);
      const auto rates = [&, k = k, d = d](double xm, double vm, double xh, double vh) {
        const double link = k * (xm - xh) + d * (vm - vh);
        return Rates{vm, sticks ? 0.0 : (motors + friction - device.viscous * vm - link) / m_m, vh,
                     (push - hand.stiffness * (xh - origin) - hand.damping * vh + link) / m_h};
      };
      const Rates a = rates(x_m, v_m, x_h, v_h);
      const auto moved = [&](const Rates& r, double t) {
        return rates(x_m + t * r.v_m, v_m + t * r.a_m, x_h + t * r.v_h, v_h + t * r.a_h);
      };
      const Rates b = moved(a, 0.5 * h), c = moved(b, 0.5 * h), e = moved(c, h);
      const double before = v_m;
      x_m += h / 6.0 * (a.v_m + 2.0 * b.v_m + 2.0 * c.v_m + e.v_m);
      v_m += h / 6.0 * (a.a_m + 2.0 * b.a_m + 2.0 * c.a_m + e.a_m);
      x_h += h / 6.0 * (a.v_h + 2.0 * b.v_h + 2.0 * c.v_h + e.v_h);
      v_h += h / 6.0 * (a.a_h + 2.0 * b.a_h + 2.0 * c.a_h + e.a_h);
      if (before * v_m < 0.0) v_m = 0.0;
    }
  }
};

/// Checks the motion with random forces, which stop the motors and start them again some fifty times.
TEST(ElasticMotion, WithDryFrictionFollowsAnIndependentIntegrator) {
  ImpedanceDeviceConfig config = elastic_device(3000.0, 0.8);
  config.viscous = 0.5;
  config.coulomb = 0.4;
  const AttachedHand hand{0.02, 200.0, 1.5};
  const auto largest_error = [&](double h) {
    FineRun fine{config, hand, h};
    ElasticMotion motion = motion_of(config, hand);
    const ElasticMotion::Stretch stretch = motion.stretch(kT);
    motion.reset({});
    Random random(4);
    double worst = 0.0;
    for (int k = 0; k < 150; ++k) {
      const double motors = 1.2 * random.normal(), push = 0.5 * random.normal();
      const double at_rest = push + hand.damping * motion.handle().velocity.x();
      motion.set_hand_force({push, 0, 0});
      motion.advance({motors, 0, 0}, stretch);
      fine.advance(motors, at_rest, fine.x_h, static_cast<int>(std::lround(kT / h)));
      worst = std::max(
          {worst, std::abs(motion.motor().position.x() - fine.x_m), std::abs(motion.handle().position.x() - fine.x_h)});
    }
    EXPECT_GT(std::abs(fine.x_h), 1e-4);
    return worst;
  };
  // In the reference, stops and starts are up to h late. At 30 m/s^2 a stop that is late by h changes the speed by 30 h
  // for some 10 ms, and the position by 3e-7 m for h = 1e-6 s. The errors of a few stops add up. The error is of first
  // order in h, so steps that are ten times finer reduce it by a factor of ten.
  const double coarse = largest_error(1e-6), fine = largest_error(1e-7);
  EXPECT_LT(coarse, 1e-6);
  EXPECT_LT(fine, 0.3 * coarse);
}

TEST(ElasticMotion, KeepsItsEnergyBalance) {
  for (const double coulomb : {0.0, 0.3}) {
    ImpedanceDeviceConfig config = elastic_device(8000.0, 0.5);
    config.viscous = 0.7;
    config.coulomb = coulomb;
    ElasticMotion motion = motion_of(config, {0.05, 300.0, 2.0});
    const ElasticMotion::Stretch first = motion.stretch(0.3 * kT), second = motion.stretch(0.7 * kT);
    motion.reset({{0.1, 0, 0}, {0.2, -0.1, 0}});
    Random random(2);
    double turned = 0.0;
    for (int k = 0; k < 2000; ++k) {
      motion.set_hand_force({random.normal(), random.normal(), random.normal()});
      motion.advance({2.0 * random.normal(), 0, random.normal()}, first);
      motion.advance({random.normal(), 0, random.normal()}, second);
      const DeviceEnergy e = motion.energy();
      turned = std::max({turned, std::abs(e.hand), std::abs(e.actuator), -e.dissipated});
      ASSERT_NEAR(e.stored, e.hand + e.actuator + e.dissipated, 1e-12 * (1.0 + turned)) << k;
    }
    EXPECT_GT(turned, 0.01);
  }
}

using Complex = std::complex<long double>;

/// Reference solution in complex long doubles: position and velocity as the sum of two exponential functions of time.
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
      // The long double reference loses digits if the exponents are nearly equal.
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
      // P is (t - S) / k. For small k t, where the difference t - S loses digits, the power series of P is used.
      const double z = k * t, P = z < 1e-4 ? t * t * (0.5 - z / 6.0 + z * z / 24.0) : (t - S) / k;
      EXPECT_NEAR(m.P, P, (z < 1e-4 ? 1e-14 : 1e-12) * P / std::min(1.0, z < 1e-4 ? 1.0 : z));
    }
  }
  const FreeMotion free = free_motion({}, 0.5);
  EXPECT_EQ(free.S, 0.5);
  EXPECT_EQ(free.P, 0.125);
  EXPECT_EQ(free.V, 1.0);
}

/// Checks the integral against Simpson's rule, whose error is (rate h)^4 / 180 = 1e-12 for the highest rate, 600 / s.
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
  laws.insert(laws.end(), {{}, {1e-7, 0.0}, {20.0, 0.0}, {20.0, 100.0}});  // the last law is critically damped
  for (const MotionLaw& law : laws) {
    for (const auto& [v, g] : {std::pair{0.1, -3.0}, {-0.1, 3.0}, {1e-9, -3.0}, {0.1, 3.0}, {-2.0, 0.3}}) {
      const double t = time_to_stop(law, v, g);
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
  EXPECT_EQ(time_to_stop({20.0, 0.0}, 0.1, 3.0), std::numeric_limits<double>::infinity()) << "it accelerates";
  EXPECT_NEAR(time_to_stop({0.0, 100.0}, 0.0, 1.0), 0.31415926535897931, 1e-15) << "half a swing";
}

constexpr double kMass = 0.2, kCoulomb = 0.5, kSpeed = 0.3;

ImpedanceDeviceConfig handle_of(double viscous, double coulomb) {
  ImpedanceDeviceConfig config;
  config.handle_mass = kMass;
  config.viscous = viscous;
  config.coulomb = coulomb;
  return config;
}

/// Returns a handle that starts at the origin with this velocity. The hand exerts no force.
HandleMotion started(const ImpedanceDeviceConfig& config, const Vec3& velocity, const AttachedHand& hand = {}) {
  HandleMotion motion(config, hand);
  motion.reset({Vec3::Zero(), velocity});
  return motion;
}

void advance(HandleMotion& motion, const Vec3& force, double time) {
  motion.advance(force, free_motion(motion.law(), time));
}

TEST(HandleMotion, StopsWhereAndWhenCoulombFrictionSays) {
  const double stop = kMass * kSpeed / kCoulomb, distance = 0.5 * kMass * kSpeed * kSpeed / kCoulomb;
  HandleMotion motion = started(handle_of(0.0, kCoulomb), {kSpeed, -kSpeed, 0.0});
  advance(motion, Vec3::Zero(), 0.999 * stop);
  EXPECT_NEAR(motion.handle().velocity.x(), 0.001 * kSpeed, 1e-15);
  EXPECT_NEAR(motion.handle().velocity.y(), -0.001 * kSpeed, 1e-15);
  advance(motion, Vec3::Zero(), 0.002 * stop);
  EXPECT_EQ(motion.handle().velocity, Vec3(0, 0, 0));
  EXPECT_NEAR(motion.handle().position.x(), distance, 1e-16);
  EXPECT_NEAR(motion.handle().position.y(), -distance, 1e-16);
}

TEST(HandleMotion, SticksUpToTheFrictionAndBreaksAwayBeyond) {
  HandleMotion motion = started(handle_of(0.0, kCoulomb), Vec3::Zero());
  advance(motion, {kCoulomb, -kCoulomb, 0.999 * kCoulomb}, 1.0);
  EXPECT_EQ(motion.handle().position, Vec3(0, 0, 0));
  EXPECT_EQ(motion.handle().velocity, Vec3(0, 0, 0));
  const double push = 1.25 * kCoulomb, time = 0.25;
  advance(motion, {push, -push, 0.0}, time);
  const double distance = 0.5 * (push - kCoulomb) / kMass * time * time;
  EXPECT_NEAR(motion.handle().position.x(), distance, 1e-15);
  EXPECT_NEAR(motion.handle().position.y(), -distance, 1e-15);
  EXPECT_EQ(motion.handle().position.z(), 0.0);
}

/// Checks a mass on a spring with dry friction. The amplitude decreases by 2 c / k in each half period, where c is the
/// friction force and k the stiffness. The mass stops where the spring force is smaller than the friction. A single
/// call of advance() computes the whole motion.
TEST(HandleMotion, SwingsOutUnderAHandWithASpring) {
  constexpr double k = 100.0, kStart = 0.0987;
  HandleMotion motion(handle_of(0.0, kCoulomb), {0.1, k, 0.0});
  motion.reset({Vec3(kStart, 0, -kStart), Vec3::Zero()});
  motion.set_hand_force({-k * kStart, 0, k * kStart});  // towards the origin
  advance(motion, Vec3::Zero(), 100.0);
  double amplitude = kStart;
  int swings = 0;
  for (; k * amplitude > kCoulomb; ++swings) amplitude -= 2.0 * kCoulomb / k;
  ASSERT_GE(swings, 9);
  const double distance = swings % 2 == 0 ? amplitude : -amplitude;
  EXPECT_EQ(motion.handle().velocity, Vec3(0, 0, 0));
  EXPECT_NEAR(motion.handle().position.x(), distance, 1e-13);
  EXPECT_NEAR(motion.handle().position.z(), -distance, 1e-13);
  EXPECT_EQ(motion.handle().position.y(), 0.0);
}

/// Checks that a sticking handle stays at rest although the spring of the hand pushes it.
TEST(HandleMotion, DoesNotChatter) {
  HandleMotion motion = started(handle_of(0.3, kCoulomb), {kSpeed, 0, 0}, {0.1, 300.0, 6.0});
  bool stuck = false;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 before = motion.handle().position;
    motion.set_hand_force(-300.0 * motion.handle().position - 6.0 * motion.handle().velocity);
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
        motion.set_hand_force({random.normal(), random.normal(), random.normal()});
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

/// Checks the dissipated energy against an independent computation from the path length (dry friction) and from the
/// speed (viscous friction).
TEST(HandleMotion, DissipatesByItsFrictionAlone) {
  constexpr double b = 2.0;
  HandleMotion motion = started(handle_of(b, kCoulomb), {kSpeed, 0, 0});
  double viscous = 0.0, path = 0.0, speed = kSpeed;
  for (int i = 0; i < 20000; ++i) {  // half-way, a force reverses the motion
    const double before = motion.handle().position.x();
    advance(motion, {i < 10000 ? 0.0 : -1.0, 0, 0}, 1e-5);
    const double displacement = motion.handle().position.x() - before,
                 mean = 0.5 * (speed + motion.handle().velocity.x());
    speed = motion.handle().velocity.x();
    viscous += b * mean * mean * 1e-5;
    path += std::abs(displacement);
  }
  // The trapezoidal rule has an error of (h / time constant)^2 = 1e-8.
  EXPECT_NEAR(motion.energy().dissipated, -viscous - kCoulomb * path, 1e-7 * (viscous + kCoulomb * path));
}

/// Checks a viscous handle that a constant force pushes from rest against x = (f / b) (t - tau (1 - exp(-t / tau))),
/// tau = m / b. The intervals between the times are shorter and longer than 0.05 tau, where the formula of a step
/// changes.
TEST(SimulateLog, FollowsTheClosedFormOfAViscousHandle) {
  constexpr double kForce = 1.5, kViscous = 4.0, kTau = 0.05;
  const LoggedHandle handle{.mass = kViscous * kTau, .viscous = kViscous};
  for (const double interval : {0.01 * kTau, 0.049 * kTau, 0.051 * kTau, 0.5 * kTau, 5.0 * kTau}) {
    std::vector<double> times(8), positions(8);
    const std::vector<double> forces(8, kForce);
    for (std::size_t k = 0; k < times.size(); ++k) times[k] = interval * static_cast<double>(k);
    simulate_log(handle, times, forces, positions);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double t = times[k], expected = kForce / kViscous * (t + kTau * std::expm1(-t / kTau));
      // The difference of t and tau (1 - exp(-t / tau)) loses the digits of t / x. Their rounding errors are 1e-16 t.
      EXPECT_NEAR(positions[k], expected, 1e-15 * (kForce / kViscous) * t) << interval / kTau << ", " << k;
    }
  }
}

}  // namespace
}  // namespace hapbench::handle_motion_test
