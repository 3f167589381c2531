#include "algorithms/registry.hpp"

#include <gtest/gtest.h>

#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::virtual_coupling_test {
namespace {

constexpr double kK = 20000.0;
constexpr double kEps = std::numeric_limits<double>::epsilon();

LawForce evaluate(ContactBuffer& contacts, std::optional<double> coupling) {
  RenderingConfig config;
  config.stiffness = kK;
  config.virtual_coupling = coupling;
  return make_law("virtual_coupling", config)->evaluate(contacts);
}

// Rounding: sums of n <= 300 terms, amplified by the condition of K_vc I + K S, at most 1 + n K / K_vc.
double rounding(const test::Dense& dense, double coupling) {
  const double n = static_cast<double>(dense.n());
  return 4 * n * kEps * (1 + n * kK / coupling);
}

TEST(VirtualCoupling, IsItsFormula) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    for (const double coupling : {kK / 10, kK, 10 * kK}) {
      const LawForce force = evaluate(contacts, coupling);
      const test::Dense dense(contacts);
      const Mat3 S_sum = dense.U * dense.U.transpose();
      const Mat3 inverse = (coupling * Mat3::Identity() + kK * S_sum).inverse();
      const Vec3 expected = -coupling * inverse * (kK * (dense.U * dense.d));
      const double tolerance = rounding(dense, coupling);
      ASSERT_LE((force.spring - expected).norm(), tolerance * coupling * dense.d.sum()) << name;
      ASSERT_LE((force.S - coupling * inverse * S_sum).norm(), tolerance * coupling / kK) << name;
      ASSERT_EQ(force.S, force.S.transpose()) << name;
    }
  });
}

TEST(VirtualCoupling, BalancesAProxyBetweenTheCouplingAndTheContacts) {
  // The coupling spring ends at a proxy displaced by y from the tool, where each contact is d_i + <y, u_i> deep: what
  // the tool feels, K_vc y, is what the contacts push the proxy with.
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    for (const double coupling : {kK / 10, kK, 10 * kK}) {
      const Vec3 felt = evaluate(contacts, coupling).spring;
      const Vec3 y = felt / coupling;
      const test::Dense dense(contacts);
      const Vec3 contact_force = -kK * (dense.U * (dense.d + dense.U.transpose() * y));
      ASSERT_LE((contact_force - felt).norm(), rounding(dense, coupling) * kK * dense.d.sum()) << name;
    }
  });
}

TEST(VirtualCoupling, OfOneContactIsTwoSpringsInSeries) {
  for (const double coupling : {kK / 10, kK, 10 * kK}) {
    ContactBuffer contacts = test::contacts_of({Vec3::UnitX()}, {0.001});
    const LawForce force = evaluate(contacts, coupling);
    const double series = 1 / (1 / kK + 1 / coupling);
    EXPECT_LE((force.spring - Vec3(-series * 0.001, 0, 0)).norm(), 8 * kEps * series * 0.001);
    EXPECT_LE((kK * force.S - Mat3(Vec3(series, 0, 0).asDiagonal())).norm(), 8 * kEps * kK);
  }
}

TEST(VirtualCoupling, TendsToSummationAsTheCouplingStiffens) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    RenderingConfig config;
    config.stiffness = kK;
    const LawForce sum = make_law("summation", config)->evaluate(contacts);
    const double n = static_cast<double>(contacts.size());
    for (const double stiffer : {1e4, 1e6, 1e8}) {
      const LawForce force = evaluate(contacts, stiffer * kK);
      // (I + x)^-1 differs from I by at most |x| for positive x = K S / K_vc, and |S| <= n.
      const double difference = n / stiffer + 8 * n * kEps;
      ASSERT_LE((force.spring - sum.spring).norm(), difference * kK * n * 0.001) << name;
      ASSERT_LE((force.S - sum.S).norm(), difference * n) << name;
    }
  });
}

TEST(VirtualCoupling, VanishesAsTheCouplingSoftens) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    for (const double softer : {1e-4, 1e-8}) {
      // Both forces are at most K_vc times the proxy's displacement, and S_sum over itself plus something is at most 1.
      ASSERT_LE(lambda_max(evaluate(contacts, softer * kK).S), softer * (1 + 1e-6)) << name;
    }
  });
}

TEST(VirtualCoupling, CouplesWithKByDefault) {
  ContactBuffer a = test::contacts_of({{1, 0, 0}, {0.6, 0.8, 0}}, {0.001, 0.0003});
  ContactBuffer b = a;
  EXPECT_EQ(evaluate(a, std::nullopt).spring, evaluate(b, kK).spring);
}

TEST(VirtualCoupling, IsNeverStifferThanTheCoupling) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    // S = K_vc S_sum / (K_vc + K S_sum) < K_vc / K in every direction.
    ASSERT_LE(lambda_max(evaluate(contacts, kK / 2).S), 0.5 * (1 + 1e-12)) << name;
  });
}

}  // namespace
}  // namespace hapbench::virtual_coupling_test
