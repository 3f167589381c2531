#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "tests/support/leapfrog.hpp"

namespace hapbench::leapfrog_test {
namespace {

using test::leapfrog;

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// A mass on a spring-damper along x.
struct Oscillator {
  double K = 20000.0, B = 0.0, M = 0.2, dt = 0.0005;
  ToolState tool;

  void step() { leapfrog(tool, {-K * x() - B * v(), 0, 0}, M, dt); }
  double x() const { return tool.pose.position.x(); }
  double v() const { return tool.velocity.x(); }
  double energy() const { return 0.5 * M * v() * v() + 0.5 * K * x() * x(); }
};

Oscillator oscillator(double B, double dt, double x, double v) {
  Oscillator o;
  o.B = B;
  o.dt = dt;
  o.tool.pose.position.x() = x;
  o.tool.velocity.x() = v;
  return o;
}

TEST(Leapfrog, VelocityIsUpdatedBeforePosition) {
  // Dyadic numbers: exact.
  ToolState tool;
  tool.pose.position = {1, 2, 3};
  tool.velocity = {0.5, 0.0, -1.0};
  leapfrog(tool, {2, 4, -8}, 4.0, 0.25);
  EXPECT_EQ(tool.velocity, Vec3(0.625, 0.25, -1.5));
  EXPECT_EQ(tool.pose.position, Vec3(1.15625, 2.0625, 2.625));
}

TEST(Leapfrog, LeavesTheAxisAlone) {
  ToolState tool;
  tool.pose.axis = {1, 0, 0};
  leapfrog(tool, {2, 4, -8}, 4.0, 0.25);
  EXPECT_EQ(tool.pose.axis, Vec3(1, 0, 0));
}

TEST(Leapfrog, FollowsTheClosedFormOfItsRecurrence) {
  // With b = B dt/M and k = K dt^2/M the positions obey x_{j+1} = (2 - b - k) x_j - (1 - b) x_{j-1}: powers of the
  // roots of z^2 - (2 - b - k) z + (1 - b), from x_0 and x_1.
  for (const double B : {0.0, 5.0, 88.5}) {
    Oscillator o = oscillator(B, 0.0005, 0.001, 0.3);
    const double b = o.B * o.dt / o.M, k = o.K * o.dt * o.dt / o.M;
    using Complex = std::complex<double>;
    const Complex root = std::sqrt(Complex((2 - b - k) * (2 - b - k) - 4 * (1 - b)));
    const Complex z1 = 0.5 * (2 - b - k + root), z2 = 0.5 * (2 - b - k - root);
    const double x0 = o.x();
    o.step();
    const double x1 = o.x();
    const Complex c1 = (x1 - z2 * x0) / (z1 - z2), c2 = (z1 * x0 - x1) / (z1 - z2);
    const double amplitude = std::abs(c1) + std::abs(c2);
    constexpr int steps = 1000;
    // Each step rounds its three terms, and a disturbance of the recurrence echoes with the amplitude 2 / |z1 - z2|.
    const double tolerance = steps * 8 * kEps * amplitude * 2.0 / std::abs(z1 - z2);
    ASSERT_LT(tolerance, 1e-9 * amplitude);
    for (int j = 2; j <= steps; ++j) {
      o.step();
      const double exact = (c1 * std::pow(z1, j) + c2 * std::pow(z2, j)).real();
      ASSERT_NEAR(o.x(), exact, tolerance) << "B = " << B << ", step " << j;
    }
  }
}

/// Position at time t of the damped oscillator M x'' + B x' + K x = 0, in closed form.
double exact_position(const Oscillator& o, double t) {
  const double decay = o.B / (2 * o.M), w = std::sqrt(o.K / o.M - decay * decay);
  return std::exp(-decay * t) * (o.x() * std::cos(w * t) + (o.v() + decay * o.x()) / w * std::sin(w * t));
}

TEST(Leapfrog, ConvergesToTheDampedOscillatorWithFirstOrder) {
  for (const double B : {0.0, 5.0, 20.0}) {
    const double end = 0.0173;  // about a period, away from zeros of the error
    std::vector<double> errors;
    for (int steps = 1000; steps <= 16000; steps *= 2) {
      Oscillator o = oscillator(B, end / steps, 0.001, 0.3);
      const double exact = exact_position(o, end);
      for (int j = 0; j < steps; ++j) o.step();
      errors.push_back(std::abs(o.x() - exact));
    }
    // error = C h + D h^2, so halving h divides it by 2 (1 + D h / C - ...): with h w = 0.006 at the coarsest, D/C of
    // the order of w, within 2 %, and twice as close after each halving.
    for (std::size_t i = 1; i < errors.size(); ++i) {
      EXPECT_NEAR(errors[i - 1] / errors[i], 2.0, 0.04 / std::pow(2.0, static_cast<double>(i - 1))) << "B = " << B;
    }
  }
}

TEST(Leapfrog, EnergyDriftIsBoundedForUndampedSpring) {
  // The scheme conserves E - K dt x v / 2 exactly. As |w x v| <= (v^2 + w^2 x^2) / 2, that is E to within the factors
  // 1 -+ q with q = w dt / 2, so E stays within (1 + q) / (1 - q) of its start, forever.
  Oscillator o = oscillator(0.0, 0.0005, 0.001, 0.3);
  const double q = std::sqrt(o.K / o.M) * o.dt / 2;
  const double bound = (1 + q) / (1 - q);
  const double start = o.energy();
  double least = start, most = start;
  for (int j = 0; j < 1000000; ++j) {
    o.step();
    least = std::min(least, o.energy());
    most = std::max(most, o.energy());
  }
  // A million steps of rounding, each of a few eps of the energy: 1e-9.
  EXPECT_LE(most / start, bound * (1 + 1e-9));
  EXPECT_GE(least / start, (1 - 1e-9) / bound);
  // The oscillation of the energy is really of that size: a bound of 1.17 that 1.0001 would satisfy tests nothing.
  EXPECT_GT(most / least, 1 + q);
}

TEST(Leapfrog, ConservesItsModifiedEnergy) {
  Oscillator o = oscillator(0.0, 0.0005, 0.001, 0.3);
  const auto modified = [&o] { return o.energy() - 0.5 * o.K * o.dt * o.x() * o.v(); };
  const double start = modified();
  constexpr int steps = 100000;
  for (int j = 0; j < steps; ++j) {
    o.step();
    ASSERT_NEAR(modified(), start, steps * 8 * kEps * start);
  }
}

TEST(Leapfrog, ConstantForceGivesTheDiscreteParabola) {
  // v_j = j a dt and x_j = a dt^2 j (j + 1) / 2: exact in dyadic numbers.
  ToolState tool;
  for (int j = 1; j <= 1000; ++j) {
    leapfrog(tool, {0, 0, -2}, 0.5, 0x1p-10);
    EXPECT_EQ(tool.velocity.z(), -4 * 0x1p-10 * j);
    EXPECT_EQ(tool.pose.position.z(), -4 * 0x1p-20 * j * (j + 1) / 2);
  }
}

}  // namespace
}  // namespace hapbench::leapfrog_test
