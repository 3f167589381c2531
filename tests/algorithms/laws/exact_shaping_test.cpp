#include "algorithms/laws/exact_shaping.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::exact_shaping_test {
namespace {

constexpr double kShapingEps = kExactShapingEpsilon;

// Closed forms of small symmetric sets: the solver leaves a residual of 1e-14 in S.
constexpr double kRounding = 2e-14;

Mat3 solve(ContactBuffer& contacts) {
  solve_exact_shaping(contacts);
  return stiffness_tensor(contacts);
}

/// n gradients in a ring around z, each with z-component `height`.
std::vector<Vec3> ring(int n, double height) {
  std::vector<Vec3> gradients;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n, r = std::sqrt(1 - height * height);
    gradients.push_back({r * std::cos(a), r * std::sin(a), height});
  }
  return gradients;
}

TEST(ExactShaping, OneContactKeepsItsSpring) {
  ContactBuffer contacts = test::contacts_of({Vec3(0.6, 0.64, 0.48)});
  solve_exact_shaping(contacts);
  EXPECT_NEAR(contacts.weight[0], 1 / (1 + kShapingEps), kRounding);
}

TEST(ExactShaping, ParallelAndOppositeContactsShareOneSpringEqually) {
  for (const std::size_t n : {2u, 7u, 8u, 9u, 1000u}) {
    std::vector<Vec3> gradients(n, Vec3::UnitY());
    for (std::size_t i = 0; i < n; i += 3) gradients[i] = -Vec3::UnitY();
    ContactBuffer contacts = test::contacts_of(gradients);
    solve_exact_shaping(contacts);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(contacts.weight[i], 1 / (static_cast<double>(n) + kShapingEps), kRounding);
    }
  }
}

TEST(ExactShaping, OrthogonalContactsKeepTheirSprings) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, -1, 0}, {0, 0, 1}});
  EXPECT_LE((solve(contacts) - Mat3::Identity() / (1 + kShapingEps)).norm(), kRounding);
}

TEST(ExactShaping, AWedgeIsShapedToItsClosedForm) {
  // Two faces with <u_1, u_2>^2 = q: c (1 + q + eps) = 1.
  for (const double degrees : {1.0, 30.0, 60.0, 89.0, 135.0, 179.0}) {
    const double a = degrees * std::numbers::pi / 180, q = std::cos(a) * std::cos(a);
    ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {std::cos(a), std::sin(a), 0}});
    solve_exact_shaping(contacts);
    EXPECT_NEAR(contacts.weight[0], 1 / (1 + q + kShapingEps), 1e-9) << degrees;
    EXPECT_NEAR(contacts.weight[1], contacts.weight[0], 1e-9) << degrees;
    EXPECT_NEAR(contacts.weight[0] + contacts.weight[1], 2 / (1 + q + kShapingEps), 4 * kRounding) << degrees;
  }
}

TEST(ExactShaping, AContactThatMakesAnotherRedundantTakesItsWeight) {
  // The middle one of three within 45 degrees already has ratio above 1 by the outer two: weight zero.
  const double r = std::sqrt(0.5);
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {std::cos(0.7), std::sin(0.7), 0}, {r, r, 0}});
  solve_exact_shaping(contacts);
  EXPECT_EQ(contacts.weight[1], 0.0);
  EXPECT_NEAR(contacts.weight[0], 1 / (1.5 + kShapingEps), 1e-9);
}

TEST(ExactShaping, ARingIsShapedToItsClosedForm) {
  // By symmetry equal weights t / n with t (s^4 / 2 + z^4 + eps / n) = 1, s^2 = 1 - z^2: S = diag(t s^2/2, t s^2/2, t
  // z^2).
  for (const double height : {0.0, 0.2, 0.5, 0.9, 0.999}) {
    for (const int n : {3, 8, 101}) {
      ContactBuffer contacts = test::contacts_of(ring(n, height));
      const double z2 = height * height, s2 = 1 - z2;
      const double t = 1 / (s2 * s2 / 2 + z2 * z2 + kShapingEps / n);
      const Mat3 expected = Vec3(t * s2 / 2, t * s2 / 2, t * z2).asDiagonal();
      EXPECT_LE((solve(contacts) - expected).norm(), 2 * kRounding) << "z = " << height << ", n = " << n;
    }
  }
}

TEST(ExactShaping, TheBoundOnLambdaMaxIsAttained) {
  // The ring with z^2 = 1/sqrt 3 in 3-D, the wedge with cos^2 = 1/sqrt 2 in the plane: no smaller bound holds.
  ContactBuffer space = test::contacts_of(ring(12, std::pow(3.0, -0.25)));
  EXPECT_NEAR(lambda_max(solve(space)), (1 + std::sqrt(3.0)) / 2, 2 * kShapingEps);
  const double x = std::pow(2.0, -0.25), y = std::sqrt(1 - x * x);
  ContactBuffer plane = test::contacts_of({{x, y, 0}, {x, -y, 0}});
  EXPECT_NEAR(lambda_max(solve(plane)), (1 + std::sqrt(2.0)) / 2, 2 * kShapingEps);
}

TEST(ExactShaping, AZeroGradientGetsNoWeight) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  solve_exact_shaping(contacts);
  EXPECT_EQ(contacts.weight[1], 0.0);
  EXPECT_NEAR(contacts.weight[0], 1 / (1 + kShapingEps), kRounding);
}

TEST(ExactShaping, ANonFiniteGradientDoesNotHang) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {bad, 0, 0}, {0, 1, 0}});
    // The answer is worthless, the next bounds check ends the run; the time it takes is bounded all the same.
    EXPECT_LE(solve_exact_shaping(contacts), 1000);
  }
}

TEST(ExactShaping, ForceIsThatOfItsWeightsAndNewtonStepsAreCounted) {
  Random random(1);
  RenderingConfig config;
  const auto law = make_law("exact_shaping", config);
  std::uint64_t steps = 0;
  for (int i = 0; i < 20; ++i) {
    std::vector<Vec3> gradients(50);
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer contacts = test::contacts_of(gradients, test::random_depths(random, 50)), same = contacts;
    const LawForce force = law->evaluate(contacts);
    steps += static_cast<std::uint64_t>(solve_exact_shaping(same));
    EXPECT_EQ(test::weights(contacts), test::weights(same));
    const test::Dense dense(contacts);
    const Eigen::VectorXd c = test::weights(contacts);
    const double rounding = 100 * std::numeric_limits<double>::epsilon();
    EXPECT_LE((force.spring - dense.spring(config.stiffness, c)).norm(),
              rounding * config.stiffness * dense.magnitude(c));
    EXPECT_LE((force.S - dense.S(c)).norm(), rounding * c.sum());
  }
  EXPECT_EQ(law->iterations(), steps);
  law->reset();
  EXPECT_EQ(law->iterations(), 0u);
}

TEST(ExactShaping, DoesNotRememberEarlierWeights) {
  Random random(2);
  std::vector<Vec3> gradients(50);
  for (Vec3& u : gradients) u = random.direction();
  ContactBuffer contacts = test::contacts_of(gradients);
  solve_exact_shaping(contacts);
  const Eigen::VectorXd first = test::weights(contacts);
  for (double& c : contacts.weight) c = 1e6;
  contacts.pad();
  solve_exact_shaping(contacts);
  EXPECT_EQ(test::weights(contacts), first);
}

}  // namespace
}  // namespace hapbench::exact_shaping_test
