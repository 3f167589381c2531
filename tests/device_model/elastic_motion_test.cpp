#include "device_model/handle_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "device_model/impedance_device.hpp"
#include "sim/core/random.hpp"

/// Motors and handle on an elastic transmission, compared with closed forms and an independent integrator.
namespace hapbench::elastic_motion_test {
namespace {

constexpr double kT = 0.001;

/// 0.06 kg of motors and 0.04 kg of handle.
ImpedanceDeviceConfig elastic_device(double stiffness, double damping) {
  ImpedanceDeviceConfig config;
  config.handle_mass = 0.1;
  config.transmission = Transmission{0.6, stiffness, damping};
  return config;
}

ElasticMotion motion_of(const ImpedanceDeviceConfig& config, const AttachedHand& hand = {}) {
  return {config, *config.transmission, hand};
}

/// Undamped, the centre of mass moves as a body of 0.1 kg, and the stretch s = x_m - x_h swings about f / (m_m w^2)
/// with w^2 = k (1 / m_m + 1 / m_h).
TEST(ElasticMotion, SwingsAsTheNormalModesDo) {
  constexpr double k = 5000.0, f = 2.0, v0 = 0.3;
  const double w = std::sqrt(k * (1.0 / 0.06 + 1.0 / 0.04)), rest = f / (0.06 * w * w);
  ElasticMotion motion = motion_of(elastic_device(k, 0.0));
  for (const double time : {1e-4, kT, 0.05}) {
    const ElasticMotion::Stretch stretch = motion.stretch(time);
    motion.reset({{1.0, 0, 0}, {v0, 0, 0}});
    motion.advance({f, 0, 0}, stretch);
    const double centre = 1.0 + v0 * time + 0.5 * f / 0.1 * time * time, s = rest * (1.0 - std::cos(w * time));
    // Doubling a piece of a quarter radian n times multiplies its rounding by 2^n = 4 w t.
    EXPECT_NEAR(motion.motor().position.x(), centre + 0.4 * s, 1e-14) << time;
    EXPECT_NEAR(motion.handle().position.x(), centre - 0.6 * s, 1e-14) << time;
    EXPECT_NEAR(motion.motor().velocity.x() - motion.handle().velocity.x(), rest * w * std::sin(w * time), 1e-13);
  }
}

/// A push F on a handle of 0.04 kg at motors that stick loads the spring with F (1 - cos(w t)), w^2 = k / m_h, and
/// breaks them loose where that is c.
TEST(ElasticMotion, StickingMotorsBreakLooseWhereTheClosedFormSays) {
  constexpr double k = 4000.0, kPush = 0.5, c = 0.7;
  ImpedanceDeviceConfig config = elastic_device(k, 0.0);
  config.coulomb = c;
  const double w = std::sqrt(k / 0.04), loose = std::acos(1.0 - c / kPush) / w;
  for (const double after : {-1e-9, 1e-9, 1e-4}) {
    ElasticMotion motion = motion_of(config);
    motion.reset({});
    motion.take_hand({kPush, 0, 0});
    const double time = loose + after;
    motion.advance(Vec3::Zero(), motion.stretch(time));
    const double swung = kPush / k * (1.0 - std::cos(w * loose)), speed = kPush * w / k * std::sin(w * loose);
    if (after < 0.0) {
      EXPECT_EQ(motion.motor().position.x(), 0.0);
      EXPECT_NEAR(motion.handle().position.x(), swung + speed * after, 1e-15);
      continue;
    }
    // From then on the spring's force grows as k speed t: v_m = k speed t^2 / (2 m_m), less (w t)^2 / 12 of it.
    const double v = 0.5 * k * speed * after * after / 0.06;
    EXPECT_NEAR(motion.motor().velocity.x(), v, (after < 1e-6 ? 1e-3 : 0.02) * v) << after;
  }
}

struct Rates {
  double v_m, a_m, v_h, a_h;
};

/// Motors and handle by the classical Runge-Kutta rule with steps of `h`; a stop or a start falls on a step.
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

/// Random forces stop the motors and break them loose some fifty times.
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
      motion.take_hand({push, 0, 0});
      motion.advance({motors, 0, 0}, stretch);
      fine.advance(motors, at_rest, fine.x_h, static_cast<int>(std::lround(kT / h)));
      worst = std::max(
          {worst, std::abs(motion.motor().position.x() - fine.x_m), std::abs(motion.handle().position.x() - fine.x_h)});
    }
    EXPECT_GT(std::abs(fine.x_h), 1e-4);
    return worst;
  };
  // The reference stops and starts up to h late. With 30 m/s^2 that is a speed of 30 h, which lasts for some 10 ms:
  // 3e-7 m for 1e-6 s, from a few stops at a time. It is first order in h, so ten times finer steps come closer
  // accordingly.
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
      motion.take_hand({random.normal(), random.normal(), random.normal()});
      motion.advance({2.0 * random.normal(), 0, random.normal()}, first);
      motion.advance({random.normal(), 0, random.normal()}, second);
      const DeviceEnergy e = motion.energy();
      turned = std::max({turned, std::abs(e.hand), std::abs(e.actuator), -e.dissipated});
      ASSERT_NEAR(e.stored, e.hand + e.actuator + e.dissipated, 1e-12 * (1.0 + turned)) << k;
    }
    EXPECT_GT(turned, 0.01);
  }
}

}  // namespace
}  // namespace hapbench::elastic_motion_test
