#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::mcneely_test {
namespace {

LawForce evaluate(ContactBuffer& contacts, std::optional<double> points = {}) {
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
    const LawForce force = evaluate(contacts);
    // n products and sums of numbers of about the same size.
    const double rounding = 1e-16 * static_cast<double>(4 * n) * springs;
    EXPECT_NEAR(force.spring.x(), -20'000.0 * 0.001 * springs, 20.0 * rounding) << n;
    EXPECT_NEAR(force.S(0, 0), springs, rounding) << n;
  }
}

TEST(McNeely, TakesItsNumberOfPointsFromItsOwnParameter) {
  ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitX(), Vec3::UnitY()}, {0.001, 0.002, 0.001});
  EXPECT_EQ(evaluate(contacts, 3.0).spring, summed(contacts).spring);
  EXPECT_TRUE(evaluate(contacts, 1.0).spring.isApprox(summed(contacts).spring / 3.0, 1e-15));
}

}  // namespace
}  // namespace hapbench::mcneely_test
