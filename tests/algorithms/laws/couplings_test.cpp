#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::couplings_test {
namespace {

constexpr double kK = 20000.0;
constexpr double kEps = std::numeric_limits<double>::epsilon();

LawForce coupled(ContactBuffer& contacts, std::optional<double> coupling) {
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
      const LawForce force = coupled(contacts, coupling);
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
  // The coupling spring ends at a proxy displaced by y from the tool, where each contact is d_i + <y, u_i> deep. The
  // force on the tool, K_vc y, equals that of the contacts on the proxy.
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    for (const double coupling : {kK / 10, kK, 10 * kK}) {
      const Vec3 felt = coupled(contacts, coupling).spring;
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
    const LawForce force = coupled(contacts, coupling);
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
      const LawForce force = coupled(contacts, stiffer * kK);
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
      // S = K_vc S_sum / (K_vc + K S_sum) is at most K_vc / K.
      ASSERT_LE(lambda_max(coupled(contacts, softer * kK).S), softer * (1 + 1e-6)) << name;
    }
  });
}

TEST(VirtualCoupling, CouplesWithKByDefault) {
  ContactBuffer a = test::contacts_of({{1, 0, 0}, {0.6, 0.8, 0}}, {0.001, 0.0003});
  ContactBuffer b = a;
  EXPECT_EQ(coupled(a, std::nullopt).spring, coupled(b, kK).spring);
}

TEST(VirtualCoupling, IsNeverStifferThanTheCoupling) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    // S = K_vc S_sum / (K_vc + K S_sum) < K_vc / K in every direction.
    ASSERT_LE(lambda_max(coupled(contacts, kK / 2).S), 0.5 * (1 + 1e-12)) << name;
  });
}

RenderingConfig config_of(double coupling, double saturation) {
  RenderingConfig config;
  config.stiffness = kK;
  config.virtual_coupling = coupling;
  config.parameters["static_coupling"]["saturation_N"] = saturation;
  return config;
}

LawForce held(ContactBuffer& contacts, double coupling, double saturation) {
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
        const Vec3 felt = held(contacts, coupling, saturation).spring;
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
  // The contacts are on one side, so the copy leaves none.
  ContactBuffer contacts =
      test::contacts_of({Vec3::UnitX(), Vec3(0.8, 0.6, 0.0), Vec3(0.8, 0.0, 0.6)}, {0.001, 0.001, 0.001});
  const LawForce force = held(contacts, 2 * kK, 1e9);
  const LawForce virtually = make_law("virtual_coupling", config_of(2 * kK, 1e9))->evaluate(contacts);
  // 1e9 N bend the spring by (f / F)^2 < 1e-13.
  EXPECT_TRUE(force.spring.isApprox(virtually.spring, 1e-12));
  EXPECT_TRUE(force.S.isApprox(virtually.S, 1e-12));
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
  EXPECT_NEAR(held(contacts, coupling, saturation).spring.y(), -kK * (depth - low), 1e-12 * kK * depth);
}

TEST(StaticCoupling, ForceAndTensorAreTheDerivativesOfItsEnergy) {
  test::for_random_contacts([](const ContactBuffer& given, const char* name) {
    const auto law = make_law("static_coupling", config_of(kK, 12.0));
    // A motion by `by` makes contacts deeper by <u, by>.
    const auto at = [&](const Vec3& by) {
      ContactBuffer contacts = given;
      for (std::size_t i = 0; i < contacts.size(); ++i) contacts.depth[i] += contacts.gradient(i).dot(by);
      const LawForce force = law->evaluate(contacts);
      return std::pair(force, law->spring_state(contacts, force.spring, Vec3::Zero()).energy);
    };
    const auto [force, energy] = at(Vec3::Zero());
    const double h = 1e-8;  // far smaller than the depths, so that few contacts separate
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 by = h * Vec3::Unit(axis);
      const auto [ahead, energy_ahead] = at(by);
      const auto [behind, energy_behind] = at(-by);
      // Errors of central differences: the rounding of the energies divided by h, and h times the change of the force
      // where contacts separate, each with a stiffness of at most K.
      const double n = static_cast<double>(given.size());
      const double off = 1e-15 * n * std::abs(energy) / h + n * kK * h;
      ASSERT_NEAR(-(energy_ahead - energy_behind) / (2 * h), force.spring[axis], off) << name;
    }
  });
}

constexpr double kRegularisations[] = {1e-4, 0.01, 1.0, 10.0};

RenderingConfig config_with(double regularisation) {
  RenderingConfig config;
  config.stiffness = kK;
  config.regularisation = regularisation;
  return config;
}

LawForce resolved(ContactBuffer& contacts, double regularisation) {
  return make_law("least_squares", config_with(regularisation))->evaluate(contacts);
}

/// Rounding of x relative to the sum of depths: sums of n <= 300 terms, amplified by the condition of eps I + S_sum, at
/// most 1 + n / eps, and by its inverse, at most 1 / eps.
double rounding_of(const test::Dense& dense, double regularisation) {
  const double n = static_cast<double>(dense.n());
  return 4 * n * kEps * (1 + n / regularisation) * (1 + 1 / regularisation);
}

TEST(LeastSquares, IsItsFormula) {
  test::for_random_contacts([](ContactBuffer contacts, const char* family) {
    for (const double eps : kRegularisations) {
      const LawForce force = resolved(contacts, eps);
      const test::Dense dense(contacts);
      const Mat3 S_sum = dense.U * dense.U.transpose();
      const Mat3 inverse = (eps * Mat3::Identity() + S_sum).inverse();
      const double tolerance = rounding_of(dense, eps);
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
      const Vec3 x = resolved(contacts, eps).spring / -kK;
      const test::Dense dense(contacts);
      const auto cost = [&](const Vec3& y) {
        return (dense.d - dense.U.transpose() * y).squaredNorm() + eps * y.squaredNorm();
      };
      // At this distance from the minimum the cost is higher by at least eps times its square, which must be far above
      // the rounding of the cost.
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
      RenderingConfig in_series;
      in_series.stiffness = kK / eps;
      in_series.virtual_coupling = kK;
      ContactBuffer same = contacts;
      const auto law = make_law("least_squares", config_with(eps)), coupling = make_law("virtual_coupling", in_series);
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
    const LawForce force = resolved(contacts, 0.01);
    EXPECT_NEAR(force.spring.x(), -kK * 0.001 * points / (points + 0.01), 1e-10);
    EXPECT_NEAR(force.S(0, 0), points / (points + 0.01), 1e-12);
  }
}

TEST(LeastSquares, IsNeverStifferThanK) {
  test::for_random_contacts([](ContactBuffer contacts, const char* family) {
    for (const double eps : kRegularisations) {
      const double n = static_cast<double>(contacts.size());
      // The largest eigenvalue is s / (eps + s) with s <= n.
      ASSERT_LE(lambda_max(resolved(contacts, eps).S), n / (eps + n) + 64 * kEps * (1 + n / eps)) << family;
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
    const Vec3 x = resolved(contacts, eps).spring / -kK;
    EXPECT_NEAR(x.y(), depth / std::sqrt(2 * eps), 1e-11 * most);
    EXPECT_NEAR(x.norm(), most, 1e-11 * most);
  }
}

}  // namespace
}  // namespace hapbench::couplings_test
