#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::couplings_test {
namespace {

constexpr double kK = 20000.0;
constexpr double kEps = std::numeric_limits<double>::epsilon();

RenderingConfig config_of(double coupling, double saturation = 1e9) {
  RenderingConfig config;
  config.stiffness = kK;
  config.virtual_coupling = coupling;
  config.parameters["static_coupling"]["saturation_N"] = saturation;
  return config;
}

// Rounding: sums of n <= 300 terms, amplified by the condition of K_vc I + K S, at most 1 + n K / K_vc.
double rounding(const test::Dense& dense, double coupling) {
  const double n = static_cast<double>(dense.n());
  return 4 * n * kEps * (1 + n * kK / coupling);
}

TEST(VirtualCoupling, IsItsFormula) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    for (const double coupling : {kK / 10, kK, 10 * kK}) {
      const LawForce force = make_law("virtual_coupling", config_of(coupling))->evaluate(contacts);
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

TEST(VirtualCoupling, AlongTheSumKeepsItsDirectionAndTakesItsStiffnessInSeries) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    for (const double coupling : {kK / 10, kK, 10 * kK}) {
      RenderingConfig config = config_of(coupling);
      config.parameters["virtual_coupling"]["along_sum"] = 1.0;
      const LawForce force = make_law("virtual_coupling", config)->evaluate(contacts);
      const test::Dense dense(contacts);
      const Vec3 sum = dense.U * dense.d;
      const double along = kK * (dense.U.transpose() * sum.normalized()).squaredNorm();
      const Vec3 expected = -coupling * kK / (coupling + along) * sum;
      const double tolerance = rounding(dense, coupling);
      ASSERT_LE((force.spring - expected).norm(), tolerance * coupling * dense.d.sum()) << name;
      ASSERT_LE((force.S - coupling / (coupling + along) * dense.U * dense.U.transpose()).norm(),
                tolerance * static_cast<double>(dense.n()))
          << name;
    }
  });
}

/// The displacement at which the coupling pulls with f: the inverse of f = K x / sqrt(1 + (K x / F)^2).
Vec3 displacement(const Vec3& f, double coupling, double saturation) {
  return f / (coupling * std::sqrt(1.0 - (f / saturation).squaredNorm()));
}

TEST(StaticCoupling, BalancesACopyBetweenTheCouplingAndTheContactsItIsStillIn) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    for (const double coupling : {kK / 10, kK, 10 * kK}) {
      for (const double saturation : {5.0, 30.0, 1e9}) {
        const Vec3 felt = make_law("static_coupling", config_of(coupling, saturation))->evaluate(contacts).spring;
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

/// Rounding of x relative to the sum of depths: sums of n <= 300 terms, amplified by the condition of eps I + S_sum, at
/// most 1 + n / eps, and by its inverse, at most 1 / eps.
double rounding_of(const test::Dense& dense, double regularisation) {
  const double n = static_cast<double>(dense.n());
  return 4 * n * kEps * (1 + n / regularisation) * (1 + 1 / regularisation);
}

TEST(LeastSquares, IsVirtualCouplingOfPenaltySpringsOverEps) {
  // Penalty springs K / eps in series with a coupling spring K; S of a coupling is in units of its penalty springs.
  test::for_random_contacts([](ContactBuffer contacts, const char* family) {
    for (const double eps : {1e-4, 0.01, 1.0, 10.0}) {
      RenderingConfig resolved = config_of(kK), in_series = resolved;
      resolved.regularisation = eps;
      in_series.stiffness = kK / eps;
      ContactBuffer same = contacts;
      const auto law = make_law("least_squares", resolved), coupling = make_law("virtual_coupling", in_series);
      const LawForce force = law->evaluate(contacts), expected = coupling->evaluate(same);
      const test::Dense dense(contacts);
      const double tolerance = rounding_of(dense, eps), force_scale = kK * dense.d.sum();
      ASSERT_LE((force.spring - expected.spring).norm(), tolerance * force_scale) << family;
      ASSERT_LE((force.S - expected.S / eps).norm(), tolerance) << family;

      const Vec3 tip(0.001, -0.002, 0.0005);
      const SpringState state = law->spring_state(contacts, force.spring, tip);
      const SpringState expected_state = coupling->spring_state(same, expected.spring, tip);
      const double energy_scale = force_scale * dense.d.sum() / eps;
      ASSERT_NEAR(state.energy, expected_state.energy, tolerance * energy_scale) << family;
      ASSERT_LE((state.moment - expected_state.moment).norm(), tolerance * force_scale / eps * tip.norm()) << family;
    }
  });
}

class Coupling : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Every, Coupling, testing::Values("virtual_coupling", "static_coupling", "least_squares"),
                         [](const auto& law) { return std::string(law.param); });

TEST_P(Coupling, ForceIsTheDerivativeOfItsEnergy) {
  test::for_random_contacts([](const ContactBuffer& given, const char* name) {
    const auto law = make_law(GetParam(), config_of(kK, 12.0));
    // A motion by `by` makes contacts deeper by <u, by>.
    const auto energy_at = [&](const Vec3& by, Vec3& spring) {
      ContactBuffer contacts = given;
      for (std::size_t i = 0; i < contacts.size(); ++i) contacts.depth[i] += contacts.gradient(i).dot(by);
      spring = law->evaluate(contacts).spring;
      return law->spring_state(contacts, spring, Vec3::Zero()).energy;
    };
    Vec3 force, other;
    const double energy = energy_at(Vec3::Zero(), force), n = static_cast<double>(given.size());
    const double h = 1e-8;  // far smaller than the depths, so that few contacts separate
    // Errors of central differences: the rounding of the energies divided by h, and h times the change of the force
    // where contacts separate, each with a stiffness of at most K.
    const double off = 1e-15 * n * energy / h + n * kK * h;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 by = h * Vec3::Unit(axis);
      ASSERT_NEAR(-(energy_at(by, other) - energy_at(-by, other)) / (2 * h), force[axis], off) << name;
    }
  });
}

}  // namespace
}  // namespace hapbench::couplings_test
