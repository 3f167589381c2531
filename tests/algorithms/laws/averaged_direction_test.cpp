#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::averaged_direction_test {
namespace {

LawForce evaluate(ContactBuffer& contacts, double K = 1.0) {
  RenderingConfig config;
  config.stiffness = K;
  return make_law("original_averaging", config)->evaluate(contacts);
}

LawForce evaluate(const std::vector<Vec3>& gradients, const std::vector<double>& depths = {}) {
  ContactBuffer contacts = test::contacts_of(gradients, depths);
  return evaluate(contacts);
}

TEST(OriginalAveraging, DividesSummedDepthsAndGradientsByTheLengthOfTheSummedGradient) {
  Random random(1);
  for (const auto& family : test::gradient_families()) {
    for (int i = 0; i < 30; ++i) {
      const auto gradients = family.draw(random, test::random_size(random, 300));
      ContactBuffer contacts = test::contacts_of(gradients, test::random_depths(random, gradients.size()));
      const test::Dense dense(contacts);
      const Vec3 sum = dense.U.rowwise().sum();
      const double n = static_cast<double>(dense.n());
      // If gradients cancel down to rounding, there is no direction.
      if (sum.norm() < 1e-6 * n) continue;
      const Vec3 u = sum / sum.norm();
      const double d = dense.d.sum() / sum.norm();

      const LawForce force = evaluate(contacts, 1234.5);
      // The sum has an error of n eps per component, its direction and inverse length that divided by its length.
      const double rounding = 4 * n * n * std::numeric_limits<double>::epsilon() / sum.norm();
      ASSERT_LE((force.spring + 1234.5 * d * u).norm(), rounding * 1234.5 * d) << family.name;
      ASSERT_LE((force.S - u * u.transpose()).norm(), rounding) << family.name;
    }
  }
}

/// n unit gradients along -x and m along +x, all of depth 1.
LawForce opposed(std::size_t n, std::size_t m) {
  std::vector<Vec3> gradients(n, -Vec3::UnitX());
  gradients.insert(gradients.end(), m, Vec3::UnitX());
  return evaluate(gradients, std::vector<double>(n + m, 1.0));
}

TEST(OriginalAveraging, OneOpposedContactTooManyMultipliesTheDepthByTheirNumber) {
  // Thesis B.3.3, with K = 1: n one way, n + 1 the other, d_r = 2 n + 1.
  for (const std::size_t n : {0u, 1u, 5u, 50u}) {
    const double count = static_cast<double>(n);
    EXPECT_EQ(opposed(n, n + 1).spring, Vec3(-(2 * count + 1), 0, 0)) << "n = " << n;
  }
}

TEST(OriginalAveraging, TwoMoreContactsFlipTheForceBy180Degrees) {
  // Thesis B.3.3: two more points on the first side give d_r = 2 n + 3 the other way.
  for (const std::size_t n : {0u, 1u, 5u, 50u}) {
    const double count = static_cast<double>(n);
    EXPECT_EQ(opposed(n + 2, n + 1).spring, Vec3(2 * count + 3, 0, 0)) << "n = " << n;
  }
}

TEST(OriginalAveraging, CancelledGradientsGiveNoForce) {
  for (const std::size_t n : {1u, 5u, 50u}) {
    const LawForce force = opposed(n, n);
    EXPECT_EQ(force.spring, Vec3(0, 0, 0));
    EXPECT_EQ(force.S, Mat3::Zero());
  }
}

TEST(OriginalAveraging, GradientsCountAsCancelledUpToABillionthOfTheirNumber) {
  // Two opposite gradients and one of length t: |sum| = t against 3e-9.
  const auto with_rest = [](double t) {
    return evaluate({Vec3::UnitX(), -Vec3::UnitX(), t * Vec3::UnitY()}).spring.norm();
  };
  EXPECT_EQ(with_rest(2.9e-9), 0.0);
  EXPECT_GT(with_rest(3.1e-9), 0.0);
}

TEST(OriginalAveraging, StiffnessIsOneAlongTheMeanGradientAndZeroAcross) {
  const Mat3 S = evaluate({{1, 0, 0}, {0, 1, 0}}).S;
  const Vec3 along = Vec3(1, 1, 0).normalized(), across = Vec3(1, -1, 0).normalized();
  EXPECT_NEAR(along.dot(S * along), 1.0, 8 * std::numeric_limits<double>::epsilon());
  EXPECT_NEAR(across.dot(S * across), 0.0, 8 * std::numeric_limits<double>::epsilon());
  EXPECT_EQ(S(2, 2), 0.0);
}

LawForce highest(const std::vector<Vec3>& gradients, const std::vector<double>& depths = {}) {
  ContactBuffer contacts = test::contacts_of(gradients, depths);
  RenderingConfig config;
  config.stiffness = 1.0;
  return make_law("highest_depth", config)->evaluate(contacts);
}

TEST(HighestDepth, IsTheDeepestContactsDepthAlongTheAveragedGradient) {
  Random random(1);
  for (const auto& family : test::gradient_families()) {
    for (int i = 0; i < 30; ++i) {
      const auto gradients = family.draw(random, test::random_size(random, 300));
      const auto depths = test::random_depths(random, gradients.size());
      const test::Dense dense(test::contacts_of(gradients, depths));
      const Vec3 sum = dense.U.rowwise().sum();
      const double n = static_cast<double>(dense.n());
      if (sum.norm() < 1e-6 * n) continue;
      const LawForce force = highest(gradients, depths);
      const Vec3 u = sum / sum.norm();
      const double rounding = 4 * n * n * std::numeric_limits<double>::epsilon() / sum.norm();
      ASSERT_LE((force.spring + dense.d.maxCoeff() * u).norm(), rounding * dense.d.maxCoeff()) << family.name;
      ASSERT_LE((force.S - u * u.transpose()).norm(), rounding) << family.name;
    }
  }
}

TEST(HighestDepth, DoesNotSeeHowManyContactsThereAre) {
  for (const std::size_t n : {1u, 9u, 64u}) {
    EXPECT_EQ(highest(std::vector<Vec3>(n, Vec3::UnitX()), std::vector<double>(n, 0.25)).spring, Vec3(-0.25, 0, 0));
  }
}

TEST(HighestDepth, TurnsRoundWhenOneOfNearlyOppositeContactsComes) {
  // The known failure: n against n + 1 points of the same depth, and then one more or two on the first side.
  const auto opposed_highest = [](std::size_t n, std::size_t m) {
    std::vector<Vec3> gradients(n, -Vec3::UnitX());
    gradients.insert(gradients.end(), m, Vec3::UnitX());
    return highest(gradients, std::vector<double>(n + m, 0.5));
  };
  EXPECT_EQ(opposed_highest(5, 6).spring, Vec3(-0.5, 0, 0));
  EXPECT_EQ(opposed_highest(6, 6).spring, Vec3(0, 0, 0));
  EXPECT_EQ(opposed_highest(6, 6).S, Mat3::Zero());
  EXPECT_EQ(opposed_highest(7, 6).spring, Vec3(0.5, 0, 0));
}

TEST(HighestDepth, OfStretchedSpringsIsTheLeastStretched) {
  // Depths of bilateral springs may all be negative; the padding's zeros are no depths.
  EXPECT_EQ(highest({Vec3::UnitX(), Vec3::UnitX()}, {-0.5, -0.25}).spring, Vec3(0.25, 0, 0));
}

TEST(HighestDepth, StoresTheEnergyOfItsOneSpring) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 1, 0}}, {0.001, 0.003});
  RenderingConfig config;
  const auto law = make_law("highest_depth", config);
  const LawForce force = law->evaluate(contacts);
  EXPECT_DOUBLE_EQ(law->spring_state(contacts, force.spring, Vec3::Zero()).energy,
                   0.5 * config.stiffness * 0.003 * 0.003);
}

}  // namespace
}  // namespace hapbench::averaged_direction_test
