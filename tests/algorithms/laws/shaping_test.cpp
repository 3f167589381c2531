#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/registry.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::shaping_test {
namespace {

// Relative tolerance of the weights and stiffness ratios. Without iterations, 20 roundings of a tensor with a norm
// below n = 100 give an error of 2e-13 in the ratios, which are at least 1. With iterations, the norm of the tensor is
// about 1, and a ratio has an error of some 1e-15. An update of the weights does not amplify relative errors: in
// logarithms of the weights, its derivative is I minus a matrix with eigenvalues in [0, 1]. Therefore the error after
// 20 updates is at most the sum of the errors of the updates.
constexpr double kTolerance = 1e-12;

ContactBuffer random_contacts(const test::GradientDistribution& family, Random& random) {
  const auto gradients = family.draw(random, test::random_size(random, 100));
  return test::contacts_of(gradients, test::random_depths(random, gradients.size()));
}

TEST(ShapedStiffness, WeightsAndRatiosEqualThoseOfTheMatrixIterationFor0To20Iterations) {
  Random random(1);
  for (const auto& family : test::gradient_distributions()) {
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
  for (const auto& family : test::gradient_distributions()) {
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

/// Tests both variants of normal projection, which differ from stiffness shaping only in their depth models.
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

// Tests exact_shaping and merged_shaping. The weights of exact_shaping must satisfy its optimality condition, which has
// a unique solution.

constexpr std::size_t kSetsOfAFamily = 25000;
constexpr std::size_t kLargestSet = 1000;

// A violation r of the optimality condition changes tr S - |S|^2 by at most r tr S, where tr S <= 3/2 + sqrt(3)/2 <
// 2.4. An upper bound of lambda_max follows from the optimality condition; the violation changes it by less.
constexpr double kTraceRounding = 2.4 * test::kShapingRounding;

/// Checks all properties of the optimum, with the tolerance of rounding in double precision.
void expect_optimal(const test::GradientDistribution& family, ContactBuffer& contacts) {
  const int steps = solve_exact_shaping(contacts);
  // One to five steps are typical. In the mixtures, clusters of several scales beside many duplicates make the active
  // set change contact by contact: the largest number of steps among 1e6 mixtures was 135.
  ASSERT_LT(steps, std::string(family.name) == "mixture" ? 200 : 60);
  const auto optimality = test::shaping_optimality(contacts, kExactShapingEpsilon);
  // The condition is written so that a NaN also fails.
  ASSERT_TRUE(optimality.smallest_weight >= 0.0 && optimality.largest_weight <= 1.0);
  ASSERT_LE(optimality.violation, test::kShapingRounding);
  ASSERT_GE(optimality.ratio_margin, -test::kShapingRounding);
  ASSERT_LE(optimality.trace_identity, kTraceRounding);
  const double bound = family.planar ? (1 + std::sqrt(2.0)) / 2 : (1 + std::sqrt(3.0)) / 2;
  ASSERT_LE(lambda_max(stiffness_tensor(contacts)), bound + kTraceRounding);
}

class ExactShapingOnFamily : public testing::TestWithParam<test::GradientDistribution> {};
INSTANTIATE_TEST_SUITE_P(Families, ExactShapingOnFamily,
                         testing::ValuesIn(test::gradient_distributions().begin(),
                                           test::gradient_distributions().end()),
                         [](const auto& family) { return std::string(family.param.name); });

TEST_P(ExactShapingOnFamily, IsOptimalAndWithinTheBounds) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(kSetsOfAFamily); ++i) {
    ContactBuffer contacts = test::contacts_of(GetParam().draw(random, test::random_size(random, kLargestSet)));
    expect_optimal(GetParam(), contacts);
    if (HasFatalFailure()) FAIL() << "set " << i << " of " << contacts.size() << " contacts";
  }
}

/// Sets of contacts for which earlier versions of the solver failed: the name of the gradient distribution, and the
/// seeds that determine the size and the gradients of each set.
const std::pair<const char*, std::vector<std::uint64_t>> kHardSets[] = {
    // For these sets, rounding hides the slope of the dual function. A line search that makes no step then stops at a
    // distance of 1e-4 from the optimum.
    {"clusters", {573042, 883808, 1649647, 2506946}},
    {"nearly_parallel", {342823, 523566}},
    {"nearly_parallel_planar", {1565149, 1653106, 1905696}},
    // For these sets, the active set changes in the last correction. A solver that only clips the negative weights
    // stops at a distance of 1e-9 from the optimum.
    {"nearly_parallel", {10976, 534807, 863432}},
    {"clusters", {2020649}},
    // For these sets, the dual point w has a small norm, so the rounding error of the products a_i . w with the tensors
    // a_i = u_i u_i^T is small, too. A solver whose tolerance is chosen for |w| = 1/eps ignores gradients and stops at
    // a distance of 0.1 from the optimum.
    {"mixture", {1943, 3501, 90246, 118655, 184124, 189569}},
    // For these sets, contacts become inactive one by one.
    {"clusters", {166086, 1300902, 2093822}},
    {"mixture", {265578, 701896}},
};

TEST(ExactShaping, IsOptimalOnSetsThatOnceDefeatedTheSolver) {
  for (const auto& [name, seeds] : kHardSets) {
    const auto families = test::gradient_distributions();
    const auto family = std::find_if(families.begin(), families.end(),
                                     [name = std::string(name)](const auto& f) { return f.name == name; });
    ASSERT_NE(family, families.end());
    for (const std::uint64_t seed : seeds) {
      Random random(seed);
      ContactBuffer contacts = test::contacts_of(family->draw(random, test::random_size(random, kLargestSet)));
      expect_optimal(*family, contacts);
      ASSERT_FALSE(HasFatalFailure()) << name << ", seed " << seed;
    }
  }
}

TEST(ExactShaping, AZeroGradientGetsNoWeight) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  solve_exact_shaping(contacts);
  EXPECT_EQ(contacts.weight[1], 0.0);
  EXPECT_NEAR(contacts.weight[0], 1 / (1 + kExactShapingEpsilon), 2e-14);
}

TEST(ExactShaping, ANonFiniteGradientDoesNotHang) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {bad, 0, 0}, {0, 1, 0}});
    // The result has no meaning. A run with such a result ends after the step, because the check of the bounds fails.
    // Therefore only the number of Newton steps must be bounded.
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
    for (double& c : same.weight) c = 1e6;  // weights of an earlier step
    same.pad();
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

constexpr double kK = 20'000.0;
constexpr double kEps = 2.3e-16;

/// Returns the result of merged_shaping at its second call, which must not depend on the first call.
LawForce evaluate(ContactBuffer& contacts) {
  RenderingConfig config;
  config.stiffness = kK;
  const auto law = make_law("merged_shaping", config);
  law->prepare(contacts.capacity());
  ContactBuffer before = contacts;
  law->evaluate(before);
  return law->evaluate(contacts);
}

TEST(MergedShaping, IsOptimalForTheTensorsOfItsGroups) {
  test::for_random_contacts([](ContactBuffer contacts, const char* family) {
    const std::size_t given = contacts.size();
    const LawForce force = evaluate(contacts);
    ASSERT_EQ(contacts.size(), given) << family;  // the law removes no contact
    const test::Dense dense(contacts);
    const Eigen::VectorXd c = test::weights(contacts);
    ASSERT_GE(c.minCoeff(), 0.0) << family;
    const Mat3 S = dense.S(c);
    const double rounding = 4 * kEps * static_cast<double>(given + 8);
    ASSERT_LE((force.S - S).norm(), rounding * (1 + S.norm())) << family;
    ASSERT_LE((force.spring - dense.spring(kK, c)).norm(), rounding * kK * 0.001 * 3) << family;  // sum c <= 3
    // Check the bounds that hold for exact_shaping. Their proof requires only that the tensor of each group of merged
    // contacts has trace 1. The solver satisfies the optimality condition to 1e-14.
    ASSERT_GE(S.trace() + 1e-12, S.squaredNorm()) << family;
    ASSERT_LE(lambda_max(S), (1 + std::sqrt(3.0)) / 2 + 1e-12) << family;
    bool same_weight = true;  // same weight for contacts with the same gradient
    for (Eigen::Index i = 0; i < c.size(); ++i) {
      double ratios = 0.0, members = 0.0;
      for (Eigen::Index j = 0; j < c.size(); ++j) {
        same_weight = same_weight && (c[j] == c[i] || dense.U.col(j) != dense.U.col(i));
        if (c[j] != c[i]) continue;
        ratios += dense.U.col(j).dot(S * dense.U.col(j));
        members += 1.0;
      }
      // Contacts with equal weight > 0 belong to one group, or to groups that happen to have the same weight. In both
      // cases the mean of the ratios of these contacts is 1 up to epsilon C <= 3e-6, where C is the sum of the weights
      // of a group.
      ASSERT_TRUE(c[i] == 0.0 || std::abs(ratios / members - 1.0) <= 3.1e-6) << family << ' ' << ratios / members;
    }
    ASSERT_TRUE(same_weight) << family;
  });
}

TEST(MergedShaping, TurnsWithTheSceneByTheTurnsOfTheCube) {
  // A random gradient does not lie on the border of two direction cells of the law. On a border, a rotation could move
  // the gradient to the other cell.
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    std::vector<Vec3> gradients;
    for (std::size_t k = 0; k < 30; ++k) gradients.push_back(random.direction());
    const std::vector<double> depths = test::random_depths(random, gradients.size());
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const LawForce force = evaluate(contacts);
    Mat3 turn;
    turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    Mat3 mirror_turn;
    mirror_turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    for (const Mat3& R : {turn, mirror_turn, Mat3(turn * mirror_turn)}) {
      std::vector<Vec3> turned;
      for (const Vec3& u : gradients) turned.emplace_back(R * u);
      ContactBuffer there = test::contacts_of(turned, depths);
      ASSERT_LE((evaluate(there).spring - R * force.spring).norm(), 1e-9 * kK * 0.03);
    }
  }
}

}  // namespace
}  // namespace hapbench::shaping_test
