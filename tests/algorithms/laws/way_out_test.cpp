// The stiffness along the way out of a wedge and of a cone, which no contact normal points along.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "algorithms/laws/exact_shaping.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::way_out_test {
namespace {

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
}  // namespace hapbench::way_out_test
