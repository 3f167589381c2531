#include "sim/contact/stiffness_tensor.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::stiffness_tensor_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// An entry of S adds n / 8 <= 13 products in each of eight partial sums, and u^T S u a few more: 20 roundings of
// numbers below n = 100, 2e-13, in a ratio that is at least its own weight, 1/2. The dense sums round as much again.
constexpr double kTolerance = 1e-12;

/// A random set with random weights in [1/2, 1).
ContactBuffer weighted_contacts(const test::GradientFamily& family, Random& random) {
  const auto gradients = family.draw(random, test::random_size(random, 100));
  ContactBuffer contacts = test::contacts_of(gradients, test::random_depths(random, gradients.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) contacts.weight[i] = random.uniform(0.5, 1.0);
  return contacts;
}

TEST(StiffnessTensor, IsTheWeightedSumOfOuterProducts) {
  Random random(1);
  for (const auto& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(100); ++i) {
      const ContactBuffer contacts = weighted_contacts(family, random);
      const Eigen::VectorXd c = test::weights(contacts);
      const Mat3 expected = test::Dense(contacts).S(c);
      const Mat3 S = stiffness_tensor(contacts);
      EXPECT_LE((S - expected).norm(), kTolerance * c.sum()) << family.name;
      EXPECT_EQ(S, S.transpose());
    }
  }
}

TEST(StiffnessTensor, RatiosEqualThoseOfTheMatrixOfSquaredInnerProducts) {
  Random random(2);
  for (const auto& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(100); ++i) {
      const ContactBuffer contacts = weighted_contacts(family, random);
      const Eigen::VectorXd rho = test::Dense(contacts).A() * test::weights(contacts);
      const RatioRange range = ratio_range(contacts, stiffness_tensor(contacts));
      EXPECT_NEAR(range.min, rho.minCoeff(), kTolerance * rho.minCoeff()) << family.name;
      EXPECT_NEAR(range.max, rho.maxCoeff(), kTolerance * rho.maxCoeff()) << family.name;
    }
  }
}

TEST(StiffnessTensor, OfNoContactsIsZero) {
  const ContactBuffer contacts(8);
  EXPECT_EQ(stiffness_tensor(contacts), Mat3::Zero());
  EXPECT_EQ(weighted_depth(contacts), Vec3::Zero());
  const RatioRange range = ratio_range(contacts, Mat3::Identity());
  EXPECT_EQ(range.min, 0.0);
  EXPECT_EQ(range.max, 0.0);
}

TEST(StiffnessTensor, RatioRangeCoversEveryContact) {
  const ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  const RatioRange range = ratio_range(contacts, Vec3(2.0, 0.5, 3.0).asDiagonal());
  EXPECT_EQ(range.min, 0.5);
  EXPECT_EQ(range.max, 3.0);
}

TEST(WeightedDepth, IsTheSumOfWeightedDepthVectors) {
  Random random(3);
  for (const auto& family : test::gradient_families()) {
    const ContactBuffer contacts = weighted_contacts(family, random);
    const test::Dense dense(contacts);
    const Eigen::VectorXd c = test::weights(contacts);
    EXPECT_LE((weighted_depth(contacts) + dense.spring(1.0, c)).norm(), kTolerance * dense.magnitude(c)) << family.name;
  }
}

TEST(LambdaMax, IsTheLargestEigenvalue) {
  Random random(4);
  for (std::size_t i = 0; i < test::cases(10000); ++i) {
    const Mat3 Q = test::random_rotation(random);
    const Vec3 eigenvalues(random.uniform(-1.0, 2.0), random.uniform(-1.0, 2.0), random.uniform(-1.0, 2.0));
    const Mat3 S = Q * eigenvalues.asDiagonal() * Q.transpose();
    // Building S and the iteration each move eigenvalues by a few roundings of the norm.
    EXPECT_NEAR(lambda_max(S), eigenvalues.maxCoeff(), 32 * kEps * eigenvalues.cwiseAbs().maxCoeff());
  }
}

TEST(LambdaMax, KeepsItsDigitsWhenTheLargestEigenvalueIsDouble) {
  Random random(5);
  for (std::size_t i = 0; i < test::cases(10000); ++i) {
    const Mat3 Q = test::random_rotation(random);
    const Mat3 S = Q * Vec3(1.0, 1.0, random.uniform()).asDiagonal() * Q.transpose();
    EXPECT_NEAR(lambda_max(S), 1.0, 32 * kEps);
  }
}

TEST(LambdaMax, OfADiagonalIsItsLargestEntry) {
  EXPECT_EQ(lambda_max(Vec3(0.25, 4.0, 1.0).asDiagonal()), 4.0);
  EXPECT_EQ(lambda_max(Mat3::Zero()), 0.0);
  EXPECT_EQ(lambda_max(-Mat3::Identity()), -1.0);
}

}  // namespace
}  // namespace hapbench::stiffness_tensor_test
