#include <gtest/gtest.h>

#include <algorithm>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::equal_weights_test {
namespace {

// Sums of n <= 300 products, each rounded: below 2 n eps of the sum of magnitudes.
constexpr double kRounding = 600 * std::numeric_limits<double>::epsilon();

/// Compares the law on random sets of all families with weights c(n) by dense matrices.
void expect_constant_weights(const char* name, double (*c_of_n)(double), const RenderingConfig& config = {}) {
  test::for_random_contacts([&](ContactBuffer contacts, const char* family) {
    const LawForce force = make_law(name, config)->evaluate(contacts);
    const test::Dense dense(contacts);
    const Eigen::VectorXd c = Eigen::VectorXd::Constant(dense.n(), c_of_n(static_cast<double>(dense.n())));
    ASSERT_EQ(test::weights(contacts), c) << family;
    ASSERT_LE((force.spring - dense.spring(config.stiffness, c)).norm(),
              kRounding * config.stiffness * dense.magnitude(c));
    ASSERT_LE((force.S - dense.S(c)).norm(), kRounding * c.sum());
  });
}

TEST(Summation, AddsAllSprings) {
  expect_constant_weights("summation", [](double) { return 1.0; });
}

TEST(Mean, DividesTheSumByTheNumberOfContacts) {
  expect_constant_weights("mean", [](double n) { return 1.0 / n; });
}

TEST(McNeely, IsTheSumUpToTenPointsAndTenMeansBeyond) {
  expect_constant_weights("mcneely", [](double n) { return std::min(1.0, 10.0 / n); });
  RenderingConfig config;
  config.stiffness = 1234.5;
  config.parameters["mcneely"]["points"] = 3.0;
  expect_constant_weights(
      "mcneely", [](double n) { return std::min(1.0, 3.0 / n); }, config);
}

}  // namespace
}  // namespace hapbench::equal_weights_test
