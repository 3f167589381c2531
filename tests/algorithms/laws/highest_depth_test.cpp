#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::highest_depth_test {
namespace {

LawForce evaluate(const std::vector<Vec3>& gradients, const std::vector<double>& depths = {}) {
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
      // As in the test of original_averaging: where gradients cancel down to rounding there is no direction.
      if (sum.norm() < 1e-6 * n) continue;
      const LawForce force = evaluate(gradients, depths);
      const Vec3 u = sum / sum.norm();
      const double rounding = 4 * n * n * std::numeric_limits<double>::epsilon() / sum.norm();
      ASSERT_LE((force.spring + dense.d.maxCoeff() * u).norm(), rounding * dense.d.maxCoeff()) << family.name;
      ASSERT_LE((force.S - u * u.transpose()).norm(), rounding) << family.name;
    }
  }
}

TEST(HighestDepth, DoesNotSeeHowManyContactsThereAre) {
  for (const std::size_t n : {1u, 9u, 64u}) {
    EXPECT_EQ(evaluate(std::vector<Vec3>(n, Vec3::UnitX()), std::vector<double>(n, 0.25)).spring, Vec3(-0.25, 0, 0));
  }
}

TEST(HighestDepth, TurnsRoundWhenOneOfNearlyOppositeContactsComes) {
  // The known failure: n against n + 1 points of the same depth, and then one more or two on the first side.
  const auto opposed = [](std::size_t n, std::size_t m) {
    std::vector<Vec3> gradients(n, -Vec3::UnitX());
    gradients.insert(gradients.end(), m, Vec3::UnitX());
    return evaluate(gradients, std::vector<double>(n + m, 0.5));
  };
  EXPECT_EQ(opposed(5, 6).spring, Vec3(-0.5, 0, 0));
  EXPECT_EQ(opposed(6, 6).spring, Vec3(0, 0, 0));
  EXPECT_EQ(opposed(6, 6).S, Mat3::Zero());
  EXPECT_EQ(opposed(7, 6).spring, Vec3(0.5, 0, 0));
}

TEST(HighestDepth, OfStretchedSpringsIsTheLeastStretched) {
  // Depths of bilateral springs may all be negative; the padding's zeros are no depths.
  EXPECT_EQ(evaluate({Vec3::UnitX(), Vec3::UnitX()}, {-0.5, -0.25}).spring, Vec3(0.25, 0, 0));
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
}  // namespace hapbench::highest_depth_test
