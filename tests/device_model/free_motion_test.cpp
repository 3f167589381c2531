#include "device_model/free_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

namespace hapbench::free_motion_test {
namespace {

using Complex = std::complex<long double>;

/// Position and velocity by the two exponentials, in complex long doubles: no part of what is tested.
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
      // Largest of either over the swing; the long double reference loses digits where the exponents are close.
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
      // (t - S) / k, by its series where that loses everything.
      const double z = k * t, P = z < 1e-4 ? t * t * (0.5 - z / 6.0 + z * z / 24.0) : (t - S) / k;
      EXPECT_NEAR(m.P, P, (z < 1e-4 ? 1e-14 : 1e-12) * P / std::min(1.0, z < 1e-4 ? 1.0 : z));
    }
  }
  const FreeMotion free = free_motion({}, 0.5);
  EXPECT_EQ(free.S, 0.5);
  EXPECT_EQ(free.P, 0.125);
  EXPECT_EQ(free.V, 1.0);
}

/// By Simpson's rule, whose error is (rate h)^4 / 180 = 1e-12 for the fastest of these, 600 / s.
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

}  // namespace
}  // namespace hapbench::free_motion_test
