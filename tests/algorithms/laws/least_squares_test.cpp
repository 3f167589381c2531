#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::least_squares_test {
namespace {

constexpr double kK = 20000.0;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kRegularisations[] = {1e-4, 0.01, 1.0, 10.0};

RenderingConfig config_with(double regularisation) {
  RenderingConfig config;
  config.stiffness = kK;
  config.regularisation = regularisation;
  return config;
}

LawForce evaluate(ContactBuffer& contacts, double regularisation) {
  return make_law("least_squares", config_with(regularisation))->evaluate(contacts);
}

/// Of x in units of a depth's sum: sums of n <= 300 terms, amplified by the condition of eps I + S_sum, at most
/// 1 + n / eps, and by its inverse, at most 1 / eps.
double rounding(const test::Dense& dense, double regularisation) {
  const double n = static_cast<double>(dense.n());
  return 4 * n * kEps * (1 + n / regularisation) * (1 + 1 / regularisation);
}

TEST(LeastSquares, IsItsFormula) {
  test::for_random_contacts([](ContactBuffer contacts, const char* family) {
    for (const double eps : kRegularisations) {
      const LawForce force = evaluate(contacts, eps);
      const test::Dense dense(contacts);
      const Mat3 S_sum = dense.U * dense.U.transpose();
      const Mat3 inverse = (eps * Mat3::Identity() + S_sum).inverse();
      const double tolerance = rounding(dense, eps);
      ASSERT_LE((force.spring + kK * inverse * (dense.U * dense.d)).norm(), tolerance * kK * dense.d.sum()) << family;
      ASSERT_LE((force.S - inverse * S_sum).norm(), tolerance) << family;
      ASSERT_EQ(force.S, force.S.transpose()) << family;
    }
  });
}

TEST(LeastSquares, ResolvesTheDepthsBetterThanAnyTranslationNearby) {
  Random random(2);
  test::for_random_contacts([&random](ContactBuffer contacts, const char* family) {
    for (const double eps : kRegularisations) {
      const Vec3 x = evaluate(contacts, eps).spring / -kK;
      const test::Dense dense(contacts);
      const auto cost = [&](const Vec3& y) {
        return (dense.d - dense.U.transpose() * y).squaredNorm() + eps * y.squaredNorm();
      };
      // Away from the minimum by a share of the depths the cost rises by at least eps times that squared; where the
      // rounding of the cost is not far below, there is nothing to see.
      const double step = 1e-3 * dense.d.maxCoeff() / std::sqrt(eps);
      ASSERT_LT(100 * 300 * kEps * cost(x), eps * step * step) << family;
      for (int i = 0; i < 10; ++i) ASSERT_GT(cost(x + step * random.direction()), cost(x)) << family << ' ' << eps;
    }
  });
}

TEST(LeastSquares, IsVirtualCouplingOfPenaltySpringsOverEps) {
  // Penalty springs K / eps in series with a coupling spring K; S of a coupling is in units of its penalty springs.
  test::for_random_contacts([](ContactBuffer contacts, const char* family) {
    for (const double eps : kRegularisations) {
      RenderingConfig coupled;
      coupled.stiffness = kK / eps;
      coupled.virtual_coupling = kK;
      ContactBuffer same = contacts;
      const auto law = make_law("least_squares", config_with(eps)), coupling = make_law("virtual_coupling", coupled);
      const LawForce force = law->evaluate(contacts), expected = coupling->evaluate(same);
      const test::Dense dense(contacts);
      const double tolerance = rounding(dense, eps), force_scale = kK * dense.d.sum();
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

TEST(LeastSquares, StoresWhatItsForceGivesBack) {
  // The force is minus the gradient of the energy: by central differences on springs, whose depths are <p, u_i>.
  test::Setting setting;
  setting.springs = SpringSet{{{1, 0, 0}, {0.6, 0.8, 0}, {-0.6, 0, 0.8}, {0, 0, 1}}, true};
  RenderingConfig config = config_with(0.01);
  config.algorithm = "least_squares";
  test::Probe probe(setting, config);
  const auto energy_at = [&probe](const Vec3& p) {
    const ToolPose pose{p, -Vec3::UnitZ()};
    probe.force_at(pose);
    return probe.algorithm().spring_state({pose, Vec3::Zero()}, probe.contacts()).energy;
  };
  const Vec3 p(0.001, -0.0005, 0.0007);
  const double h = 1e-6;
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    gradient[axis] = (energy_at(p + h * Vec3::Unit(axis)) - energy_at(p - h * Vec3::Unit(axis))) / (2 * h);
  }
  // Exact for a quadratic energy but for its rounding over h.
  const Vec3 force = probe.force_at({p, -Vec3::UnitZ()}).spring;
  EXPECT_LE((force + gradient).norm(), 1e-7 * force.norm());
}

TEST(LeastSquares, OfParallelContactsApproachesKAsTheirNumberGrows) {
  for (const std::size_t n : {1u, 4u, 100u}) {
    const double points = static_cast<double>(n);
    ContactBuffer contacts = test::contacts_of(std::vector<Vec3>(n, Vec3::UnitX()), std::vector<double>(n, 0.001));
    const LawForce force = evaluate(contacts, 0.01);
    EXPECT_NEAR(force.spring.x(), -kK * 0.001 * points / (points + 0.01), 1e-10);
    EXPECT_NEAR(force.S(0, 0), points / (points + 0.01), 1e-12);
  }
}

TEST(LeastSquares, IsNeverStifferThanK) {
  test::for_random_contacts([](ContactBuffer contacts, const char* family) {
    for (const double eps : kRegularisations) {
      const double n = static_cast<double>(contacts.size());
      // The largest eigenvalue is s / (eps + s) with s <= n.
      ASSERT_LE(lambda_max(evaluate(contacts, eps).S), n / (eps + n) + 64 * kEps * (1 + n / eps)) << family;
    }
  });
}

TEST(LeastSquares, ReachesItsForceBoundInTheWedgeWhoseSingularValueIsTheRootOfEps) {
  // Two faces with 2 sin^2 w = eps, equally deep: the way out needs d / sqrt(2 eps).
  for (const double eps : {1e-4, 0.01, 1.0}) {
    const double s = std::sqrt(eps / 2), c = std::sqrt(1 - s * s), depth = 0.001;
    ContactBuffer contacts = test::contacts_of({{c, s, 0}, {-c, s, 0}}, {depth, depth});
    const RenderingConfig config = config_with(eps);
    const double most = find_algorithm("least_squares")->theory.force_bound(config, Cylinder{}, 2, depth);
    const Vec3 x = evaluate(contacts, eps).spring / -kK;
    EXPECT_NEAR(x.y(), depth / std::sqrt(2 * eps), 1e-11 * most);
    EXPECT_NEAR(x.norm(), most, 1e-11 * most);
  }
}

}  // namespace
}  // namespace hapbench::least_squares_test
