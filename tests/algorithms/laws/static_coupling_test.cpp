#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::static_coupling_test {
namespace {

constexpr double kK = 20000.0;

RenderingConfig config_of(double coupling, double saturation) {
  RenderingConfig config;
  config.stiffness = kK;
  config.virtual_coupling = coupling;
  config.parameters["static_coupling"]["saturation_N"] = saturation;
  return config;
}

LawForce evaluate(ContactBuffer& contacts, double coupling, double saturation) {
  return make_law("static_coupling", config_of(coupling, saturation))->evaluate(contacts);
}

/// The displacement at which the coupling pulls with f: the inverse of f = K x / sqrt(1 + (K x / F)^2).
Vec3 displacement(const Vec3& f, double coupling, double saturation) {
  return f / (coupling * std::sqrt(1.0 - (f / saturation).squaredNorm()));
}

TEST(StaticCoupling, BalancesACopyBetweenTheCouplingAndTheContactsItIsStillIn) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    for (const double coupling : {kK / 10, kK, 10 * kK}) {
      for (const double saturation : {5.0, 30.0, 1e9}) {
        const Vec3 felt = evaluate(contacts, coupling, saturation).spring;
        ASSERT_LT(felt.norm(), saturation) << name;
        const Vec3 s = displacement(felt, coupling, saturation);
        const test::Dense dense(contacts);
        Eigen::VectorXd pressed = dense.d + dense.U.transpose() * s;
        for (Eigen::Index i = 0; i < pressed.size(); ++i)
          if (pressed[i] * dense.d[i] <= 0.0) pressed[i] = 0.0;
        const Vec3 pushed = -kK * (dense.U * pressed);
        // The law balances to 1e-13 K |pressed|; the inverse divides by 1 - (f / F)^2, which loses the digits that
        // saturation takes, and the contacts multiply what is left by up to n K / K_vc.
        const double kept = 1.0 - (felt / saturation).squaredNorm();
        const double n = static_cast<double>(dense.n());
        const double lost = 1e-15 / kept * (1.0 + n * kK / coupling) * felt.norm() + 1e-12 * kK * dense.d.norm();
        ASSERT_LE((pushed - felt).norm(), 4.0 * lost) << name << ' ' << coupling << ' ' << saturation;
      }
    }
  });
}

TEST(StaticCoupling, WithoutSaturationIsTheVirtualCouplingOfTheContactsItStaysIn) {
  // Contacts on one side: the copy leaves none.
  ContactBuffer contacts =
      test::contacts_of({Vec3::UnitX(), Vec3(0.8, 0.6, 0.0), Vec3(0.8, 0.0, 0.6)}, {0.001, 0.001, 0.001});
  const LawForce force = evaluate(contacts, 2 * kK, 1e9);
  const LawForce coupled = make_law("virtual_coupling", config_of(2 * kK, 1e9))->evaluate(contacts);
  // 1e9 N bend the spring by (f / F)^2 < 1e-13.
  EXPECT_TRUE(force.spring.isApprox(coupled.spring, 1e-12));
  EXPECT_TRUE(force.S.isApprox(coupled.S, 1e-12));
}

TEST(StaticCoupling, OfOneContactIsAQuarticInClosedForm) {
  // K (d - x) = K_vc x / sqrt(1 + (K_vc x / F)^2), solved by bisection instead.
  const double coupling = 3 * kK, saturation = 8.0, depth = 0.001;
  double low = 0.0, high = depth;
  for (int i = 0; i < 200; ++i) {
    const double x = 0.5 * (low + high);
    const double pull = coupling * x / std::hypot(1.0, coupling * x / saturation);
    (kK * (depth - x) > pull ? low : high) = x;
  }
  ContactBuffer contacts = test::contacts_of({Vec3::UnitY()}, {depth});
  EXPECT_NEAR(evaluate(contacts, coupling, saturation).spring.y(), -kK * (depth - low), 1e-12 * kK * depth);
}

TEST(StaticCoupling, ForceAndTensorAreTheDerivativesOfItsEnergy) {
  test::for_random_contacts([](const ContactBuffer& given, const char* name) {
    const auto law = make_law("static_coupling", config_of(kK, 12.0));
    // Moved by `by`, contacts are deeper by <u, by>.
    const auto at = [&](const Vec3& by) {
      ContactBuffer contacts = given;
      for (std::size_t i = 0; i < contacts.size(); ++i) contacts.depth[i] += contacts.gradient(i).dot(by);
      const LawForce force = law->evaluate(contacts);
      return std::pair(force, law->spring_state(contacts, force.spring, Vec3::Zero()).energy);
    };
    const auto [force, energy] = at(Vec3::Zero());
    const double h = 1e-8;  // small beside the depths, so that few contacts let go in between
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 by = h * Vec3::Unit(axis);
      const auto [ahead, energy_ahead] = at(by);
      const auto [behind, energy_behind] = at(-by);
      // Central differences: rounding of the energies over h, and h times the change of the force where contacts let
      // go, of which each has a stiffness of K at most.
      const double n = static_cast<double>(given.size());
      const double off = 1e-15 * n * std::abs(energy) / h + n * kK * h;
      ASSERT_NEAR(-(energy_ahead - energy_behind) / (2 * h), force.spring[axis], off) << name;
    }
  });
}

}  // namespace
}  // namespace hapbench::static_coupling_test
