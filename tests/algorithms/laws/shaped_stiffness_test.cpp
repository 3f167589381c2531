#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/registry.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/setting.hpp"

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

/// Both kinds of normal projection differ from stiffness shaping in their depth models only.
class NormalProjectionLaw : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Both, NormalProjectionLaw,
                         testing::Values("normal_projection", "continuous_normal_projection"),
                         [](const auto& law) { return std::string(law.param); });

TEST_P(NormalProjectionLaw, IsStiffnessShapingOnItsDepthModelWithTheSameIterations) {
  for (const test::AnalyticScene& scene : test::analytic_scenes()) {
    for (const int m : {0, 3, 10}) {
      RenderingConfig projected = test::config_for(GetParam(), scene);
      projected.iterations = m;
      RenderingConfig shaped = projected;
      shaped.algorithm = "shaped_stiffness";
      shaped.depth_model = GetParam();  // depth model and law have the same name
      test::Probe a(scene.setting(), projected), b(scene.setting(), shaped);
      const RenderedForce force = a.force_at(scene.setting().pose);
      EXPECT_EQ(test::hash_of(force, a.contacts()), test::hash_of(b.force_at(scene.setting().pose), b.contacts()))
          << scene.name << " m = " << m;
    }
  }
}

// Sums of a dozen products of numbers below 12, and up to 2000 updates that contract: some hundred eps.
constexpr double kRounding = 1e-13;
constexpr double kHalfAngles[] = {0.1, 0.2, 0.5, std::numbers::pi / 4, 1.0, 1.4};

/// Gradients of two faces at the half angle w from the plane x = 0, so that the way out is +y.
std::vector<Vec3> wedge(double w, std::size_t on_one, std::size_t on_other) {
  std::vector<Vec3> gradients(on_one, Vec3(std::cos(w), -std::sin(w), 0.0));
  gradients.insert(gradients.end(), on_other, Vec3(-std::cos(w), -std::sin(w), 0.0));
  return gradients;
}

/// Gradients of a cone of half angle w, evenly around its axis +y. An odd number, so that none lies opposite another.
std::vector<Vec3> cone(double w, int count) {
  std::vector<Vec3> gradients;
  for (int i = 0; i < count; ++i) {
    const Eigen::AngleAxisd turn(2.0 * std::numbers::pi * i / count, Vec3::UnitY());
    gradients.emplace_back(turn * Vec3(std::cos(w), -std::sin(w), 0.0));
  }
  return gradients;
}

/// S of an algorithm whose tool is pressed a millimetre into such springs.
Mat3 tensor(const char* algorithm, const std::vector<Vec3>& gradients, int iterations = 3) {
  test::Setting setting;
  setting.springs = SpringSet{gradients, false};
  RenderingConfig config;
  config.algorithm = algorithm;
  config.iterations = iterations;
  return test::Probe(setting, config).force_at({{0.0, -1e-3, 0.0}, -Vec3::UnitY()}).S;
}

double square(double x) {
  return x * x;
}

TEST(WayOutOfAWedge, OfSumAndMeanFollowsTheNumbersOfPointsAsTheyAre) {
  for (const double w : kHalfAngles) {
    const Mat3 sum = tensor("summation", wedge(w, 7, 2)), mean = tensor("mean", wedge(w, 7, 2));
    EXPECT_NEAR(sum(1, 1), 9.0 * square(std::sin(w)), kRounding);
    EXPECT_NEAR(sum(0, 0), 9.0 * square(std::cos(w)), kRounding);
    EXPECT_NEAR(sum(0, 1), -5.0 * std::sin(w) * std::cos(w), kRounding) << "the axes of the tensor turn";
    EXPECT_NEAR(mean(1, 1), square(std::sin(w)), kRounding);
    EXPECT_NEAR(mean(0, 0), square(std::cos(w)), kRounding);
  }
}

TEST(WayOutOfAWedge, OfConvergedShapingDependsOnTheAngleAlone) {
  for (const double w : kHalfAngles) {
    // The weights of face 1 add up to C1 with C1 + q C2 = 1, those of face 2 likewise; q is their gradients' squared
    // inner product.
    const double q = square(std::cos(2.0 * w));
    const double along = 2.0 * square(std::sin(w)) / (1.0 + q), across = 2.0 * square(std::cos(w)) / (1.0 + q);
    for (const std::size_t on_other : {2u, 7u}) {
      // epsilon c adds to each equation at most epsilon, which the least eigenvalue 1 - q of [1 q; q 1] divides.
      const Mat3 exact = tensor("exact_shaping", wedge(w, 7, on_other));
      const double tolerance = 2.0 * kExactShapingEpsilon / (1.0 - q);
      EXPECT_NEAR(exact(1, 1), along, tolerance);
      EXPECT_NEAR(exact(0, 0), across, tolerance);
      // An update multiplies the error by 1 - (1 - q) / (1 + q), at w = 0.1 by 0.98: 2000 of them leave 1e-17 of it.
      const Mat3 shaped = tensor("shaped_stiffness", wedge(w, 7, on_other), 2000);
      EXPECT_NEAR(shaped(1, 1), along, kRounding);
      EXPECT_NEAR(shaped(0, 0), across, kRounding);
    }
  }
}

TEST(WayOutOfAWedge, IsSoftAsTheSquareOfASmallAngle) {
  // 2 sin^2 w / (1 + cos^2 2w) = w^2 (1 + 5/3 w^2 + …).
  for (const double w : {0.01, 0.02, 0.05}) {
    EXPECT_NEAR(tensor("shaped_stiffness", wedge(w, 3, 3))(1, 1) / square(w), 1.0, 2.0 * square(w));
  }
}

TEST(WayOutOfAWedge, OfTheProxyIsFullyStiffWhenBothFacesHold) {
  for (const double w : kHalfAngles) {
    const Mat3 S = tensor("proxy", wedge(w, 7, 2));
    // The projector onto the plane of the gradients, whose angle 2 w or pi - 2 w of at least 0.2 divides rounding.
    EXPECT_LE((S - Mat3(Vec3(1.0, 1.0, 0.0).asDiagonal())).norm(), 10.0 * kRounding) << S;
  }
}

TEST(WayOutOfACone, OfShapingIsTwiceThatOfAWedgeForSmallAngles) {
  for (const double w : kHalfAngles) {
    // Around the axis sum u u^T = n diag(cos^2 w / 2, sin^2 w, cos^2 w / 2), so a ratio is n c (cos^4 w / 2 + sin^4 w).
    const double c2 = square(std::cos(w)), s2 = square(std::sin(w)), scale = square(c2) + 2.0 * square(s2);
    for (const char* algorithm : {"shaped_stiffness", "exact_shaping"}) {
      const Mat3 S = tensor(algorithm, cone(w, 5));
      const double tolerance = algorithm == std::string("exact_shaping") ? 3.0 * kExactShapingEpsilon : kRounding;
      EXPECT_NEAR(S(1, 1), 2.0 * s2 / scale, tolerance) << algorithm << " at " << w;
      EXPECT_NEAR(S(0, 0), c2 / scale, tolerance) << algorithm << " at " << w;
      EXPECT_NEAR(S(2, 2), c2 / scale, tolerance) << algorithm << " at " << w;
    }
  }
}

TEST(WayOutOfACone, OfTheProxyIsFullyStiff) {
  for (const double w : kHalfAngles) {
    EXPECT_LE((tensor("proxy", cone(w, 5)) - Mat3::Identity()).norm(), 10.0 * kRounding / square(std::sin(w)));
  }
}

}  // namespace
}  // namespace hapbench::shaped_stiffness_test
