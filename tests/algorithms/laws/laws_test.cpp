#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::laws_test {
namespace {

// Rounding error of a sum of n <= 300 products, divided by the sum of the magnitudes of the products: below 2 n eps.
constexpr double kRounding = 600 * std::numeric_limits<double>::epsilon();

/// Checks the weights, force and tensor of the law on random contacts from all gradient distributions. All weights of n
/// contacts must be `c_of_n`(n). The expected force and tensor are computed from these weights with dense matrices.
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

/// A law with one spring along the averaged gradient. The depth of this spring is a function of the depths of the
/// contacts and of `length` = |sum u_i|.
struct Law {
  const char* name;
  double (*depth)(const Eigen::VectorXd& depths, double length);
};
const Law kLaws[] = {{"original_averaging", [](const Eigen::VectorXd& d, double length) { return d.sum() / length; }},
                     {"highest_depth", [](const Eigen::VectorXd& d, double) { return d.maxCoeff(); }}};

/// Returns the result of a law with K = 1.
LawForce evaluate(const char* law, const std::vector<Vec3>& gradients, const std::vector<double>& depths = {}) {
  ContactBuffer contacts = test::contacts_of(gradients, depths);
  RenderingConfig config;
  config.stiffness = 1.0;
  return make_law(law, config)->evaluate(contacts);
}

TEST(AveragedDirection, IsOneSpringAlongTheSummedGradient) {
  RenderingConfig config;
  config.stiffness = 1234.5;
  for (const Law& law : kLaws) {
    test::for_random_contacts([&](ContactBuffer contacts, const char* family) {
      const test::Dense dense(contacts);
      const Vec3 sum = dense.U.rowwise().sum();
      const double n = static_cast<double>(dense.n()), length = sum.norm();
      // If the gradients nearly cancel, the direction is not defined well enough to be compared.
      if (length < 1e-6 * n) return;
      const Vec3 u = sum / length;
      const double d = law.depth(dense.d, length);

      const LawForce force = make_law(law.name, config)->evaluate(contacts);
      // The sum of n unit gradients has an error of up to n^2 eps: n roundings of partial sums of up to n. The
      // direction u and the factor 1 / length have this error divided by `length`.
      const double rounding = 4 * n * n * std::numeric_limits<double>::epsilon() / length;
      ASSERT_LE((force.spring + 1234.5 * d * u).norm(), rounding * 1234.5 * d) << law.name << ' ' << family;
      ASSERT_LE((force.S - u * u.transpose()).norm(), rounding) << law.name << ' ' << family;
    });
  }
}

TEST(AveragedDirection, TurnsRoundWhereOneOfOpposedContactsComes) {
  // Section B.3.3 of the thesis: m contacts push in one direction, and m - 1, m or m + 1 contacts in the opposite
  // direction. If the numbers differ by 1, original_averaging adds the depths of all contacts.
  for (const Law& law : kLaws) {
    for (const int n : {0, 1, 5, 50}) {
      for (const int more : {-1, 0, 1}) {
        const int m = n + 1, all = 2 * m + more;
        std::vector<Vec3> gradients(static_cast<std::size_t>(m), Vec3::UnitX());
        gradients.resize(static_cast<std::size_t>(all), -Vec3::UnitX());
        const LawForce force = evaluate(law.name, gradients, std::vector<double>(gradients.size(), 1.0));
        EXPECT_EQ(force.spring, Vec3(more * law.depth(Eigen::VectorXd::Ones(all), 1.0), 0, 0)) << law.name << ' ' << n;
        EXPECT_EQ(force.S, more == 0 ? Mat3(Mat3::Zero()) : Mat3(Vec3::UnitX().asDiagonal())) << law.name << ' ' << n;
      }
    }
  }
}

TEST(AveragedDirection, CountsGradientsAsCancelledUpToABillionthOfTheirNumber) {
  // Sum two opposite gradients and a gradient of length t: |sum| = t is compared with the threshold 3e-9.
  const auto with_rest = [](double t) {
    return evaluate("original_averaging", {Vec3::UnitX(), -Vec3::UnitX(), t * Vec3::UnitY()}).spring.norm();
  };
  EXPECT_EQ(with_rest(2.9e-9), 0.0);
  EXPECT_GT(with_rest(3.1e-9), 0.0);
}

TEST(HighestDepth, OfStretchedSpringsIsTheSmallestElongation) {
  // Depths of bilateral springs may all be negative; the zeros of the padding do not count as depths.
  EXPECT_EQ(evaluate("highest_depth", {Vec3::UnitX(), Vec3::UnitX()}, {-0.5, -0.25}).spring, Vec3(0.25, 0, 0));
}

TEST(HighestDepth, StoresTheEnergyOfItsOneSpring) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 1, 0}}, {0.001, 0.003});
  RenderingConfig config;
  const auto law = make_law("highest_depth", config);
  const LawForce force = law->evaluate(contacts);
  EXPECT_DOUBLE_EQ(law->spring_state(contacts, force.spring, Vec3::Zero()).energy,
                   0.5 * config.stiffness * 0.003 * 0.003);
}

constexpr double kEps = std::numeric_limits<double>::epsilon();

LawForce tandpasta(ContactBuffer& contacts) {
  return make_law("tandpasta", {})->evaluate(contacts);
}

/// Checks the weights beta_i / sigma_E and the force of section F.2 of the thesis against dense matrices.
TEST(Tandpasta, IsItsFormula) {
  test::for_random_contacts([](ContactBuffer contacts, const char* name) {
    const test::Dense dense(contacts);
    const Eigen::MatrixXd inner = dense.U.transpose() * dense.U;
    const Eigen::VectorXd beta = inner.rowwise().sum().cwiseAbs().cwiseQuotient(inner.cwiseAbs().rowwise().sum());
    const Eigen::VectorXd d2 = dense.d.array().square();
    const double s = beta.dot(d2) / d2.sum();
    // The error of beta is up to n eps, because beta is a sum of n inner products divided by a sum of at least 1. The
    // division by s amplifies this error in c = beta / s.
    const double rounding = 8 * static_cast<double>(dense.n()) * kEps / s;
    if (s < 1e-9) return;  // near the energy threshold of the law, rounding decides whether the force is zero
    const Eigen::VectorXd c = beta / s;
    const LawForce force = tandpasta(contacts);
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
    const LawForce force = tandpasta(contacts);
    EXPECT_EQ(force.spring == Vec3::Zero(), test::weights(contacts).norm() == 0.0);
    EXPECT_EQ(force.spring == Vec3::Zero(), force.S == Mat3::Zero());
    return force.spring.norm();
  };
  // Two opposite springs, one of them rotated by an angle t, have beta = (1 - cos t) / (1 + cos t) = t^2 / 4.
  const auto at_angle = [&](double t) { return force_of({{1, 0, 0}, {-std::cos(t), std::sin(t), 0}}, 0.001); };
  EXPECT_EQ(at_angle(0.0), 0.0) << "all springs cancel";
  EXPECT_EQ(at_angle(1.9e-6), 0.0);
  EXPECT_GT(at_angle(2.1e-6), 0.0);
  EXPECT_EQ(force_of({{1, 0, 0}, {0, 1, 0}}, 0.0), 0.0) << "springs without depth";
}

constexpr double kK = 20000.0;

RenderingConfig config_of(double coupling, double saturation = 1e9) {
  RenderingConfig config;
  config.stiffness = kK;
  config.virtual_coupling = coupling;
  config.parameters["static_coupling"]["saturation_N"] = saturation;
  return config;
}

// Returns the rounding error of sums of n <= 300 terms, amplified by the condition number of the matrix K_vc I + K
// S_sum. K_vc is `coupling`, and the condition number is at most 1 + n K / K_vc.
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

/// Returns the displacement x at which the coupling exerts the force f: the inverse of f = K x / sqrt(1 + (K x / F)^2),
/// where K is `coupling` [N/m] and F is `saturation` [N].
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
        // The law finds the equilibrium to 1e-13 K |pressed|. displacement() computes the difference 1 - (f / F)^2,
        // which loses digits if the force f is close to the saturation F. The contacts multiply the error of the
        // displacement by up to n K / K_vc, where K_vc is `coupling`.
        const double kept = 1.0 - (felt / saturation).squaredNorm();
        const double n = static_cast<double>(dense.n());
        const double lost = 1e-15 / kept * (1.0 + n * kK / coupling) * felt.norm() + 1e-12 * kK * dense.d.norm();
        ASSERT_LE((pushed - felt).norm(), 4.0 * lost) << name << ' ' << coupling << ' ' << saturation;
      }
    }
  });
}

/// Returns the rounding error of S, which is also the rounding error of the force divided by K times the sum of the
/// depths. The error of sums of n <= 300 terms is amplified by the condition number of eps I + S_sum, at most 1 + n /
/// eps, and by the norm of the inverse of this matrix, at most 1 / eps.
double rounding_of(const test::Dense& dense, double regularisation) {
  const double n = static_cast<double>(dense.n());
  return 4 * n * kEps * (1 + n / regularisation) * (1 + 1 / regularisation);
}

TEST(LeastSquares, IsVirtualCouplingOfPenaltySpringsOverEps) {
  // Penalty springs of stiffness K / eps act in series with a coupling spring of stiffness K. virtual_coupling returns
  // its S in units of the stiffness K / eps of its penalty springs.
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
    // A displacement `by` makes contacts deeper by <u, by>.
    const auto energy_at = [&](const Vec3& by, Vec3& spring) {
      ContactBuffer contacts = given;
      for (std::size_t i = 0; i < contacts.size(); ++i) contacts.depth[i] += contacts.gradient(i).dot(by);
      spring = law->evaluate(contacts).spring;
      return law->spring_state(contacts, spring, Vec3::Zero()).energy;
    };
    Vec3 force, other;
    const double energy = energy_at(Vec3::Zero(), force), n = static_cast<double>(given.size());
    const double h = 1e-8;  // far smaller than the depths, so that few contacts separate
    // Errors of central differences: the rounding of the energies divided by h, plus h times the change of the
    // stiffness where contacts separate, at most K for each contact.
    const double off = 1e-15 * n * energy / h + n * kK * h;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 by = h * Vec3::Unit(axis);
      ASSERT_NEAR(-(energy_at(by, other) - energy_at(-by, other)) / (2 * h), force[axis], off) << name;
    }
  });
}

}  // namespace
}  // namespace hapbench::laws_test
