#include "algorithms/registry.hpp"

#include <gtest/gtest.h>

#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::tandpasta_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

LawForce evaluate(ContactBuffer& contacts) {
  return make_law("tandpasta", {})->evaluate(contacts);
}

/// sigma_E of thesis F.2, from dense matrices.
double sigma(const test::Dense& dense) {
  const Eigen::MatrixXd inner = dense.U.transpose() * dense.U;
  const Eigen::VectorXd beta = inner.rowwise().sum().cwiseAbs().cwiseQuotient(inner.cwiseAbs().rowwise().sum());
  const Eigen::VectorXd d2 = dense.d.array().square();
  return beta.dot(d2) / d2.sum();
}

template <class F>
void for_random_contacts(F f) {
  Random random(1);
  for (const auto& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(30); ++i) {
      const auto gradients = family.draw(random, test::random_size(random, 200));
      f(test::contacts_of(gradients, test::random_depths(random, gradients.size())), family.name);
    }
  }
}

TEST(Tandpasta, IsItsFormula) {
  for_random_contacts([](ContactBuffer contacts, const char* name) {
    const test::Dense dense(contacts);
    const double s = sigma(dense);
    // Betas are off by up to n eps (sums of n inner products over a sum of at least 1); c = beta / sigma amplifies
    // that.
    const double rounding = 8 * static_cast<double>(dense.n()) * kEps / s;
    if (s < 1e-9) return;  // near the threshold rounding decides
    const Eigen::VectorXd c = test::tandpasta_weights(dense);
    const LawForce force = evaluate(contacts);
    ASSERT_LE((test::weights(contacts) - c).cwiseAbs().maxCoeff(), rounding * c.maxCoeff()) << name;
    const double magnitude = dense.d.sum() * c.maxCoeff();
    ASSERT_LE((force.spring - dense.spring(RenderingConfig{}.stiffness, c)).norm(),
              2 * rounding * RenderingConfig{}.stiffness * magnitude)
        << name;
    ASSERT_LE((force.S - dense.S(c)).norm(), 2 * rounding * c.maxCoeff() * static_cast<double>(dense.n())) << name;
  });
}

TEST(Tandpasta, KeepsTheElasticEnergy) {
  for_random_contacts([](ContactBuffer contacts, const char* name) {
    const LawForce force = evaluate(contacts);
    if (force.spring == Vec3::Zero()) return;
    const test::Dense dense(contacts);
    const Eigen::VectorXd d2 = dense.d.array().square();
    // Sums of n <= 200 positive terms.
    ASSERT_NEAR(test::weights(contacts).dot(d2), d2.sum(), 400 * kEps * d2.sum()) << name;
  });
}

TEST(Tandpasta, ASpringThatNoOtherOpposesKeepsItsShare) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0.001, 0.002, 0.003});
  evaluate(contacts);
  EXPECT_EQ(test::weights(contacts), Eigen::VectorXd(Vec3(1, 1, 1)));
}

TEST(Tandpasta, MovesEnergyFromOpposedSpringsToTheOthers) {
  // An opposed pair along x has beta = 0; the spring along y takes the energy of all three.
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}}, {0.002, 0.002, 0.001});
  const LawForce force = evaluate(contacts);
  EXPECT_EQ(contacts.weight[0], 0.0);
  EXPECT_EQ(contacts.weight[1], 0.0);
  EXPECT_NEAR(contacts.weight[2], 9.0, 16 * kEps * 9);
  EXPECT_EQ(force.spring.x(), 0.0);
  EXPECT_NEAR(force.spring.y(), -RenderingConfig{}.stiffness * 9 * 0.001, 1e-12);
}

TEST(Tandpasta, GivesNoForceWhenAllSpringsCancel) {
  for (const std::size_t pairs : {1u, 4u, 50u}) {
    std::vector<Vec3> gradients(pairs, Vec3::UnitX());
    gradients.insert(gradients.end(), pairs, -Vec3::UnitX());
    ContactBuffer contacts = test::contacts_of(gradients);
    const LawForce force = evaluate(contacts);
    EXPECT_EQ(force.spring, Vec3(0, 0, 0));
    EXPECT_EQ(force.S, Mat3::Zero());
    EXPECT_EQ(test::weights(contacts).norm(), 0.0);
  }
}

TEST(Tandpasta, GivesNoForceBelowItsEnergyThreshold) {
  // Two opposed springs, one turned by an angle t: beta = (1 - cos t) / (1 + cos t) = t^2 / 4 for both.
  const auto force_at = [](double t) {
    ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {-std::cos(t), std::sin(t), 0}});
    return evaluate(contacts).spring.norm();
  };
  EXPECT_EQ(force_at(1.9e-6), 0.0);
  EXPECT_GT(force_at(2.1e-6), 0.0);
}

TEST(Tandpasta, GivesNoForceForSpringsWithoutDepth) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 1, 0}}, {0.0, 0.0});
  EXPECT_EQ(evaluate(contacts).spring, Vec3(0, 0, 0));
}

}  // namespace
}  // namespace hapbench::tandpasta_test
