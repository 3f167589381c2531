#include <gtest/gtest.h>

#include <string>

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

TEST(ShapedStiffness, AZeroGradientGetsNoWeight) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 0, 0}});
  const Mat3 S = shape_weights(contacts, 3);
  EXPECT_EQ(S, Mat3(Vec3::UnitX().asDiagonal()));
  EXPECT_EQ(contacts.weight[1], 0.0);
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

}  // namespace
}  // namespace hapbench::shaped_stiffness_test
