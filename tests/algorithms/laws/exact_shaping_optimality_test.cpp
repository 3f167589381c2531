// The optimality conditions and the bounds they imply on seeded sets of 21 families.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <string>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "sim/contact/stiffness_tensor.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::exact_shaping_optimality_test {
namespace {

constexpr std::size_t kSetsOfAFamily = 25000;
constexpr std::size_t kLargestSet = 1000;

// A violation r of the condition moves tr S - |S|^2 by at most r tr S, tr S <= 3/2 + sqrt(3)/2 < 2.4, and the bound on
// lambda_max that follows from it by less than that.
constexpr double kTraceRounding = 2.4 * test::kShapingRounding;

/// Everything that holds at the optimum, with the tolerance of double rounding.
void expect_optimal(const test::GradientFamily& family, ContactBuffer& contacts) {
  const int steps = solve_exact_shaping(contacts);
  // Typical are one to five, see TakesAboutTwoNewtonSteps below. Clusters at several scales beside many duplicates,
  // which only the mixtures have, make the active set change contact by contact: 135 steps were the worst of 1e6.
  ASSERT_LT(steps, std::string(family.name) == "mixture" ? 200 : 60);
  const auto optimality = test::shaping_optimality(contacts, kExactShapingEpsilon);
  // Written so that NaN fails, too.
  ASSERT_TRUE(optimality.smallest_weight >= 0.0 && optimality.largest_weight <= 1.0);
  ASSERT_LE(optimality.violation, test::kShapingRounding);
  ASSERT_GE(optimality.ratio_margin, -test::kShapingRounding);
  ASSERT_LE(optimality.trace_identity, kTraceRounding);
  const double bound = family.planar ? (1 + std::sqrt(2.0)) / 2 : (1 + std::sqrt(3.0)) / 2;
  ASSERT_LE(lambda_max(stiffness_tensor(contacts)), bound + kTraceRounding);
}

const auto name_of_family = [](const auto& family) { return std::string(family.param.name); };

class ExactShapingOnFamily : public testing::TestWithParam<test::GradientFamily> {};
INSTANTIATE_TEST_SUITE_P(Families, ExactShapingOnFamily,
                         testing::ValuesIn(test::gradient_families().begin(), test::gradient_families().end()),
                         name_of_family);

TEST_P(ExactShapingOnFamily, IsOptimalAndWithinTheBounds) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(kSetsOfAFamily); ++i) {
    ContactBuffer contacts = test::contacts_of(GetParam().draw(random, test::random_size(random, kLargestSet)));
    expect_optimal(GetParam(), contacts);
    if (HasFatalFailure()) FAIL() << "set " << i << " of " << contacts.size() << " contacts";
  }
}

TEST_P(ExactShapingOnFamily, TensorDoesNotDependOnTheOrderOfTheContacts) {
  Random random(2);
  for (std::size_t i = 0; i < test::cases(300); ++i) {
    const auto gradients = GetParam().draw(random, test::random_size(random, kLargestSet));
    ContactBuffer contacts = test::contacts_of(gradients);
    ContactBuffer permuted = test::contacts_of(test::shuffled(gradients, random));
    solve_exact_shaping(contacts);
    solve_exact_shaping(permuted);
    // Both sets of weights are optimal to rounding.
    const double tolerance = test::tensor_tolerance(gradients.size(), 2 * test::kShapingRounding, kExactShapingEpsilon);
    ASSERT_LE((stiffness_tensor(contacts) - stiffness_tensor(permuted)).norm(), tolerance) << "set " << i;
  }
}

TEST_P(ExactShapingOnFamily, TensorDependsContinuouslyOnTheGradients) {
  Random random(3);
  for (std::size_t i = 0; i < test::cases(100); ++i) {
    const auto gradients = GetParam().draw(random, test::random_size(random, 100));
    const double n = static_cast<double>(gradients.size());
    ContactBuffer contacts = test::contacts_of(gradients);
    solve_exact_shaping(contacts);
    const Mat3 S = stiffness_tensor(contacts);
    for (const double change : {1e-4, 1e-6, 1e-8, 1e-10}) {
      auto changed_gradients = gradients;
      for (Vec3& u : changed_gradients) u = (u + change * random.direction()).normalized();
      ContactBuffer changed = test::contacts_of(changed_gradients);
      solve_exact_shaping(changed);
      // Each u u^T changes by E_i, |E_i| <= 2 sqrt 2 change (change of u at most 2 change after normalising, to first
      // order sqrt 2 of it in u u^T; doubled to be safe for the second order). That changes the gradient of the
      // objective at contact i, <U_i, S - I> + eps c_i, by at most |E_i| |S - I| + |U_i| sum c_j |E_j| <= |E| (sqrt 3
      // + 2.4), and a violation r of that size the tensor by sqrt n r / (2 sqrt eps); S itself moves with the U_i by
      // sum c |E|.
      const double E = 4 * std::sqrt(2.0) * change;
      const double violation = E * (std::sqrt(3.0) + 2.4) + 2 * test::kShapingRounding;
      const double tolerance = test::tensor_tolerance(gradients.size(), violation, kExactShapingEpsilon) + 2.4 * E;
      ASSERT_LE((stiffness_tensor(changed) - S).norm(), tolerance) << "n = " << n << ", change " << change;
    }
  }
}

/// A set drawn as in the search that found it: Random(seed), size, gradients.
struct HardSet {
  const char* family;
  std::uint64_t seed;
};

class ExactShapingOnHardSets : public testing::Test {
 protected:
  static void expect_optimal_on(std::initializer_list<HardSet> sets) {
    for (const HardSet& set : sets) {
      for (const test::GradientFamily& family : test::gradient_families()) {
        if (family.name != std::string(set.family)) continue;
        Random random(set.seed);
        ContactBuffer contacts = test::contacts_of(family.draw(random, test::random_size(random, kLargestSet)));
        expect_optimal(family, contacts);
        ASSERT_FALSE(HasFatalFailure()) << set.family << ", seed " << set.seed;
      }
    }
  }
};

// Each of these once defeated the solver.

TEST_F(ExactShapingOnHardSets, DoesNotStandStillWhereTheSlopeOfTheDualIsLostInRounding) {
  // A line search that makes no step stops 1e-4 from the optimum.
  expect_optimal_on({{"clusters", 573042},
                     {"clusters", 883808},
                     {"clusters", 1649647},
                     {"clusters", 2506946},
                     {"nearly_parallel", 342823},
                     {"nearly_parallel", 523566},
                     {"nearly_parallel_planar", 1565149},
                     {"nearly_parallel_planar", 1653106},
                     {"nearly_parallel_planar", 1905696}});
}

TEST_F(ExactShapingOnHardSets, FollowsTheActiveSetThroughTheLastCorrection) {
  // Clipping what the correction makes negative, and no more, stops 1e-9 from the optimum.
  expect_optimal_on(
      {{"nearly_parallel", 10976}, {"nearly_parallel", 534807}, {"nearly_parallel", 863432}, {"clusters", 2020649}});
}

TEST_F(ExactShapingOnHardSets, DoesNotTakeSmallGradientsOfAWellScaledDualForRounding) {
  // The rounding of a_i . w is small if |w| is. A tolerance for |w| = 1/eps stops 0.1 from the optimum.
  expect_optimal_on({{"mixture", 1943},
                     {"mixture", 3501},
                     {"mixture", 90246},
                     {"mixture", 118655},
                     {"mixture", 184124},
                     {"mixture", 189569}});
}

TEST_F(ExactShapingOnHardSets, EndsWithinItsStepsWhereContactsLeaveOneByOne) {
  expect_optimal_on(
      {{"clusters", 166086}, {"clusters", 1300902}, {"clusters", 2093822}, {"mixture", 265578}, {"mixture", 701896}});
}

TEST_F(ExactShapingOnHardSets, WeighsDuplicatesAlike) {
  for (const std::size_t n : {8u, 1000u}) {
    Random random(4);
    const std::vector<Vec3> few = {random.direction(), random.direction(), random.direction(), random.direction()};
    std::vector<Vec3> gradients;
    for (std::size_t i = 0; i < n; ++i) gradients.push_back(few[i % few.size()]);
    ContactBuffer contacts = test::contacts_of(gradients);
    solve_exact_shaping(contacts);
    // The problem is strictly convex, and the sums are the same to the bit.
    for (std::size_t i = few.size(); i < n; ++i) EXPECT_EQ(contacts.weight[i], contacts.weight[i % few.size()]);
  }
}

TEST_F(ExactShapingOnHardSets, TakesAboutTwoNewtonStepsWhereGradientsAreSpread) {
  Random random(5);
  int steps = 0;
  const int sets = 200;
  for (int i = 0; i < sets; ++i) {
    std::vector<Vec3> gradients(test::random_size(random, kLargestSet));
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer contacts = test::contacts_of(gradients);
    steps += solve_exact_shaping(contacts);
  }
  EXPECT_LT(steps, 2 * sets);
}

}  // namespace
}  // namespace hapbench::exact_shaping_optimality_test
