// exact_shaping against an independent solver, and as the limit of the thesis's iteration.
#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::exact_shaping_reference_test {
namespace {

constexpr double kShapingEps = kExactShapingEpsilon;

/// The defining problem as nonnegative least squares: minimise |[U; sqrt(eps) I] c - [I; 0]|, U's columns the nine
/// entries of u u^T.
Eigen::VectorXd weights_by_least_squares(const test::Dense& contacts) {
  const Eigen::Index n = contacts.n();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(9 + n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Mat3 tensor = contacts.U.col(i) * contacts.U.col(i).transpose();
    A.col(i).head<9>() = tensor.reshaped();
    A(9 + i, i) = std::sqrt(kShapingEps);
  }
  Eigen::VectorXd b = Eigen::VectorXd::Zero(9 + n);
  b.head<9>() = Mat3::Identity().reshaped();
  return test::nonnegative_least_squares(A, b);
}

TEST(ExactShaping, EqualsAnIndependentNonnegativeLeastSquaresSolution) {
  Random random(1);
  for (const auto& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(100); ++i) {
      ContactBuffer contacts = test::contacts_of(family.draw(random, test::random_size(random, 40)));
      const test::Dense dense(contacts);
      const Eigen::VectorXd reference = weights_by_least_squares(dense);

      // The reference is certified on its own before it is believed.
      ContactBuffer certified = contacts;
      for (std::size_t k = 0; k < contacts.size(); ++k) certified.weight[k] = reference[static_cast<Eigen::Index>(k)];
      ASSERT_GE(reference.minCoeff(), 0.0);
      ASSERT_LE(test::shaping_optimality(certified, kShapingEps).violation, test::kShapingRounding) << family.name;

      solve_exact_shaping(contacts);
      const double violation = 2 * test::kShapingRounding;
      ASSERT_LE((stiffness_tensor(contacts) - dense.S(reference)).norm(),
                test::tensor_tolerance(contacts.size(), violation, kShapingEps))
          << family.name << ", set " << i;
      ASSERT_LE((test::weights(contacts) - reference).norm(),
                test::weight_tolerance(contacts.size(), violation, kShapingEps))
          << family.name << ", set " << i;
    }
  }
}

/// f(c) = c^T A c / 2 - 1^T c = |S|^2 / 2 - tr S, what the iteration minimises.
double objective(const Mat3& S) {
  return 0.5 * S.squaredNorm() - S.trace();
}

TEST(ExactShaping, IsWhatTheShapingIterationTendsTo) {
  // The update minimises the auxiliary function of Sha et al. (2007); with it and log rho <= rho - 1 one finds for any
  // weights c* that  f(c_m) - f(c*) <= (D(c*) + 2 (f(c_0) - f(c_m))) / m,  D(c*) = sum c* log c* - c* + 1: the
  // iteration approaches the optimum at least like 1/m. And by the optimality of c* for eps,
  // |S_m - S*|^2 / 2 <= f(c_m) - f(c*) + eps <c*, c_m>.
  Random random(2);
  for (const auto& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(10); ++i) {
      ContactBuffer contacts = test::contacts_of(family.draw(random, test::random_size(random, 50)));
      solve_exact_shaping(contacts);
      const Mat3 exact = stiffness_tensor(contacts);
      const Eigen::VectorXd c = test::weights(contacts);
      double divergence = 0.0;
      for (const double ci : c) divergence += (ci > 0.0 ? ci * std::log(ci) : 0.0) - ci + 1.0;

      Mat3 S = shape_weights(contacts, 0);
      const double start = objective(S);
      int m = 0;
      for (const int iterations : {1, 10, 100, 1000, 10000}) {
        for (; m < iterations; ++m) S = update_shaped_weights(contacts, S);
        // Rounding of the objective, numbers of at most n^2.
        const double rounding = 1e-12 * (1.0 + std::abs(start));
        const double bound = (divergence + 2 * (start - objective(S))) / m + rounding;
        ASSERT_LE(objective(S) - objective(exact), bound) << family.name << ", m = " << m;
        ASSERT_LE(0.5 * (S - exact).squaredNorm(), bound + kShapingEps * c.dot(test::weights(contacts)))
            << family.name << ", m = " << m;
      }
    }
  }
}

TEST(ExactShaping, IsCloseToManyIterationsOnGenericSets) {
  // The bound above is worst case; sets without near-degeneracy come much closer: three digits after 10000 iterations.
  Random random(3);
  for (std::size_t i = 0; i < test::cases(30); ++i) {
    std::vector<Vec3> gradients(3 + random.below(30));
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer exact = test::contacts_of(gradients), iterated = exact;
    solve_exact_shaping(exact);
    const Mat3 S = stiffness_tensor(exact);
    const double after_3 = (shape_weights(iterated, 3) - S).norm();
    const double after_10000 = (shape_weights(iterated, 10000) - S).norm();
    EXPECT_LE(after_10000, 1e-3);
    EXPECT_LE(after_10000, after_3);
  }
}

}  // namespace
}  // namespace hapbench::exact_shaping_reference_test
