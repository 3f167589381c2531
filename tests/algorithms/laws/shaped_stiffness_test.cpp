#include "algorithms/laws/shaped_stiffness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::shaped_stiffness_test {
namespace {

// Without iterations 20 roundings of a tensor below n = 100, 2e-13, in ratios of at least 1; with them the tensor is of
// the order of 1 and a ratio off by some 1e-15. An update of the weights does not amplify relative errors (in
// logarithms it is I minus a matrix with eigenvalues in [0, 1]), so after 20 of them the errors have at most added up.
constexpr double kTolerance = 1e-12;

ContactBuffer random_contacts(const test::GradientFamily& family, Random& random) {
  const auto gradients = family.draw(random, test::random_size(random, 100));
  return test::contacts_of(gradients, test::random_depths(random, gradients.size()));
}

TEST(ShapedStiffness, WeightsAndRatiosEqualThoseOfTheMatrixIterationFor0To20Iterations) {
  Random random(1);
  for (const auto& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(30); ++i) {
      ContactBuffer contacts = random_contacts(family, random);
      const Eigen::MatrixXd A = test::Dense(contacts).A();
      for (int m = 0; m <= 20; ++m) {
        const Eigen::VectorXd expected = test::shaped_weights(A, m);
        const Mat3 S = shape_weights(contacts, m);
        const Eigen::VectorXd error = (test::weights(contacts) - expected).cwiseQuotient(expected).cwiseAbs();
        ASSERT_LE(error.maxCoeff(), kTolerance) << family.name << ", m = " << m;

        const Eigen::VectorXd rho = A * expected;
        const RatioRange range = ratio_range(contacts, S);
        ASSERT_NEAR(range.min, rho.minCoeff(), kTolerance * rho.minCoeff()) << family.name << ", m = " << m;
        ASSERT_NEAR(range.max, rho.maxCoeff(), kTolerance * rho.maxCoeff()) << family.name << ", m = " << m;
      }
    }
  }
}

TEST(ShapedStiffness, ReturnsTheTensorOfTheWeightsItLeaves) {
  Random random(2);
  for (const auto& family : test::gradient_families()) {
    ContactBuffer contacts = random_contacts(family, random);
    for (const int m : {0, 1, 3}) {
      const Mat3 S = shape_weights(contacts, m);
      EXPECT_EQ(S, stiffness_tensor(contacts)) << family.name;
    }
  }
}

TEST(ShapedStiffness, UpdatesContinueWhereAnEarlierCallStopped) {
  Random random(3);
  for (const auto& family : test::gradient_families()) {
    ContactBuffer at_once = random_contacts(family, random);
    ContactBuffer one_by_one = at_once;
    const Mat3 S = shape_weights(at_once, 7);
    Mat3 T = shape_weights(one_by_one, 4);
    for (int m = 4; m < 7; ++m) T = update_shaped_weights(one_by_one, T);
    EXPECT_EQ(S, T) << family.name;
    EXPECT_EQ(test::weights(at_once), test::weights(one_by_one)) << family.name;
  }
}

TEST(ShapedStiffness, ForceIsThatOfTheShapedWeights) {
  Random random(4);
  for (const auto& family : test::gradient_families()) {
    for (const int m : {0, 3, 20}) {
      ContactBuffer contacts = random_contacts(family, random);
      const test::Dense dense(contacts);
      const Eigen::VectorXd c = test::shaped_weights(dense.A(), m);
      RenderingConfig config;
      config.iterations = m;
      const LawForce force = make_law("shaped_stiffness", config)->evaluate(contacts);
      EXPECT_LE((force.spring - dense.spring(config.stiffness, c)).norm(),
                kTolerance * config.stiffness * dense.magnitude(c));
      EXPECT_LE((force.S - dense.S(c)).norm(), kTolerance * c.sum());
    }
  }
}

TEST(ShapedStiffness, ThreeIterationsAreTheDefault) {
  EXPECT_EQ(RenderingConfig{}.iterations, 3);
}

TEST(ShapedStiffness, ParallelContactsShareOneStiffness) {
  for (const std::size_t n : {1u, 2u, 8u, 64u}) {
    ContactBuffer contacts = test::contacts_of(std::vector<Vec3>(n, Vec3::UnitY()));
    const Mat3 S = shape_weights(contacts, 1);
    EXPECT_EQ(S, Mat3(Vec3::UnitY().asDiagonal()));
    for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(contacts.weight[i], 1.0 / static_cast<double>(n));
  }
}

TEST(ShapedStiffness, OrthogonalContactsDoNotTouchEachOther) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, -1, 0}, {0, 0, 1}});
  EXPECT_EQ(shape_weights(contacts, 5), Mat3::Identity());
}

TEST(ShapedStiffness, AZeroGradientGetsNoWeight) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 0, 0}});
  const Mat3 S = shape_weights(contacts, 3);
  EXPECT_EQ(S, Mat3(Vec3::UnitX().asDiagonal()));
  EXPECT_EQ(contacts.weight[1], 0.0);
}

TEST(ShapedStiffness, CountsItsIterationsUntilReset) {
  RenderingConfig config;
  config.iterations = 4;
  const auto law = make_law("shaped_stiffness", config);
  ContactBuffer contacts = test::contacts_of({Vec3::UnitX()});
  for (int step = 1; step <= 3; ++step) {
    law->evaluate(contacts);
    EXPECT_EQ(law->iterations(), 4u * static_cast<unsigned>(step));
  }
  law->reset();
  EXPECT_EQ(law->iterations(), 0u);
}

TEST(ShapedStiffness, LowersTheQuadraticObjectiveInEveryIteration) {
  // The update is that of Sha, Lin, Saul, Lee (2007) for min c^T A c / 2 - 1^T c, and it never goes up: by rounding of
  // numbers of the order of the objective, |S|^2 / 2 + tr S, at most.
  Random random(5);
  for (const auto& family : test::gradient_families()) {
    ContactBuffer contacts = random_contacts(family, random);
    const auto objective = [](const Mat3& S) { return 0.5 * S.squaredNorm() - S.trace(); };
    Mat3 S = shape_weights(contacts, 0);
    for (int m = 1; m <= 50; ++m) {
      const double before = objective(S), size = S.squaredNorm() + S.trace();
      S = update_shaped_weights(contacts, S);
      ASSERT_LE(objective(S), before + kTolerance * size) << family.name << ", m = " << m;
    }
  }
}

TEST(ShapedStiffness, IsNowhereStifferThanTheProvedBound) {
  // The bound is one of weighted updates (results/reference/BEYOND.md). S is a sum of n <= 100 positive terms of the
  // order of 1, each rounded a few times.
  constexpr double kRounding = 1000 * std::numeric_limits<double>::epsilon();
  Random random(7);
  for (const auto& family : test::gradient_families()) {
    const double bound = 0.5 * (1.0 + std::sqrt(family.planar ? 2.0 : 3.0));
    for (int set = 0; set < 200; ++set) {
      ContactBuffer contacts = random_contacts(family, random);
      Mat3 S = shape_weights(contacts, 0);
      for (int m = 1; m <= 10; ++m) {
        S = update_shaped_weights(contacts, S);
        ASSERT_LE(lambda_max(S), bound + kRounding) << family.name << ", m = " << m;
      }
    }
  }
}

}  // namespace
}  // namespace hapbench::shaped_stiffness_test
