#include "algorithms/registry.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::tandpasta_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

LawForce evaluate(ContactBuffer& contacts) {
  return make_law("tandpasta", {})->evaluate(contacts);
}

/// Beta_i and sigma_E of thesis F.2, from dense matrices.
TEST(Tandpasta, IsItsFormula) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    const test::Dense dense(contacts);
    const Eigen::MatrixXd inner = dense.U.transpose() * dense.U;
    const Eigen::VectorXd beta = inner.rowwise().sum().cwiseAbs().cwiseQuotient(inner.cwiseAbs().rowwise().sum());
    const Eigen::VectorXd d2 = dense.d.array().square();
    const double s = beta.dot(d2) / d2.sum();
    // Betas are off by up to n eps (sums of n inner products over a sum of at least 1); c = beta / sigma amplifies
    // that.
    const double rounding = 8 * static_cast<double>(dense.n()) * kEps / s;
    if (s < 1e-9) return;  // near the threshold rounding decides
    const Eigen::VectorXd c = beta / s;
    const LawForce force = evaluate(contacts);
    ASSERT_LE((test::weights(contacts) - c).cwiseAbs().maxCoeff(), rounding * c.maxCoeff()) << name;
    const double magnitude = dense.d.sum() * c.maxCoeff();
    ASSERT_LE((force.spring - dense.spring(RenderingConfig{}.stiffness, c)).norm(),
              2 * rounding * RenderingConfig{}.stiffness * magnitude)
        << name;
    ASSERT_LE((force.S - dense.S(c)).norm(), 2 * rounding * c.maxCoeff() * static_cast<double>(dense.n())) << name;
  });
}

TEST(Tandpasta, GivesNoForceUpToItsEnergyThreshold) {
  const auto force_of = [](const std::vector<Vec3>& gradients, double depth) {
    ContactBuffer contacts = test::contacts_of(gradients, std::vector<double>(gradients.size(), depth));
    const LawForce force = evaluate(contacts);
    EXPECT_EQ(force.spring == Vec3::Zero(), test::weights(contacts).norm() == 0.0);
    EXPECT_EQ(force.spring == Vec3::Zero(), force.S == Mat3::Zero());
    return force.spring.norm();
  };
  // Two opposed springs, one turned by an angle t: beta = (1 - cos t) / (1 + cos t) = t^2 / 4 for both.
  const auto at_angle = [&](double t) { return force_of({{1, 0, 0}, {-std::cos(t), std::sin(t), 0}}, 0.001); };
  EXPECT_EQ(at_angle(0.0), 0.0) << "all springs cancel";
  EXPECT_EQ(at_angle(1.9e-6), 0.0);
  EXPECT_GT(at_angle(2.1e-6), 0.0);
  EXPECT_EQ(force_of({{1, 0, 0}, {0, 1, 0}}, 0.0), 0.0) << "springs without depth";
}

}  // namespace
}  // namespace hapbench::tandpasta_test
