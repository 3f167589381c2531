#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::equal_weights_test {
namespace {

// Sums of n <= 300 products, each rounded: below 2 n eps of the sum of magnitudes.
constexpr double kRounding = 600 * std::numeric_limits<double>::epsilon();

/// Evaluates the law on random sets of all families and compares with weights c(n) by dense matrices.
void expect_constant_weights(const char* name, double (*c_of_n)(double)) {
  Random random(1);
  RenderingConfig config;
  config.stiffness = 1234.5;
  for (const auto& family : test::gradient_families()) {
    for (int i = 0; i < 30; ++i) {
      const auto gradients = family.draw(random, test::random_size(random, 300));
      ContactBuffer contacts = test::contacts_of(gradients, test::random_depths(random, gradients.size()));
      const LawForce force = make_law(name, config)->evaluate(contacts);

      const test::Dense dense(contacts);
      const Eigen::VectorXd c = Eigen::VectorXd::Constant(dense.n(), c_of_n(static_cast<double>(dense.n())));
      ASSERT_EQ(test::weights(contacts), c) << family.name;
      ASSERT_LE((force.spring - dense.spring(config.stiffness, c)).norm(),
                kRounding * config.stiffness * dense.magnitude(c));
      ASSERT_LE((force.S - dense.S(c)).norm(), kRounding * c.sum());
    }
  }
}

TEST(Summation, AddsAllSprings) {
  expect_constant_weights("summation", [](double) { return 1.0; });
}

TEST(Mean, DividesTheSumByTheNumberOfContacts) {
  expect_constant_weights("mean", [](double n) { return 1.0 / n; });
}

TEST(Summation, GrowsWithTheNumberOfParallelContacts) {
  RenderingConfig config;
  ContactBuffer contacts = test::contacts_of(std::vector<Vec3>(64, Vec3::UnitX()), std::vector<double>(64, 0x1p-10));
  EXPECT_EQ(make_law("summation", config)->evaluate(contacts).spring, Vec3(-config.stiffness * 64 * 0x1p-10, 0, 0));
}

TEST(Mean, IsSoftWhereMostContactsPointElsewhere) {
  // The springs demo of thesis A.2: one upward spring among 64 gets 1/64 of its stiffness.
  std::vector<Vec3> gradients(63, Vec3::UnitX());
  gradients.push_back(Vec3::UnitY());
  ContactBuffer contacts = test::contacts_of(gradients);
  EXPECT_EQ(make_law("mean", {})->evaluate(contacts).S(1, 1), 1.0 / 64);
}

LawForce mcneely(ContactBuffer& contacts, std::optional<double> points = {}) {
  RenderingConfig config;
  if (points) config.parameters["mcneely"]["points"] = *points;
  return make_law("mcneely", config)->evaluate(contacts);
}

LawForce summed(ContactBuffer contacts) {
  return make_law("summation", RenderingConfig{})->evaluate(contacts);
}

TEST(McNeely, IsTheSumUpToTenPointsAndTenMeansBeyond) {
  for (const std::size_t n : {1u, 10u, 11u, 40u}) {
    ContactBuffer contacts = test::contacts_of(std::vector<Vec3>(n, Vec3::UnitX()), std::vector<double>(n, 0.001));
    const double springs = n <= 10 ? static_cast<double>(n) : 10.0;
    const LawForce force = mcneely(contacts);
    // n products and sums of numbers of about the same size.
    const double rounding = 1e-16 * static_cast<double>(4 * n) * springs;
    EXPECT_NEAR(force.spring.x(), -20'000.0 * 0.001 * springs, 20.0 * rounding) << n;
    EXPECT_NEAR(force.S(0, 0), springs, rounding) << n;
  }
}

TEST(McNeely, TakesItsNumberOfPointsFromItsOwnParameter) {
  ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitX(), Vec3::UnitY()}, {0.001, 0.002, 0.001});
  EXPECT_EQ(mcneely(contacts, 3.0).spring, summed(contacts).spring);
  EXPECT_TRUE(mcneely(contacts, 1.0).spring.isApprox(summed(contacts).spring / 3.0, 1e-15));
}

}  // namespace
}  // namespace hapbench::equal_weights_test
