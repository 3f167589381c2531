#include "algorithms/stages/damping_and_limits.hpp"

#include <gtest/gtest.h>

#include "sim/contact/stiffness_tensor.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::damping_and_limits_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Dyadic values, so that products below are exact: B = 2 zeta sqrt(K M) = 2 * 0.75 * 64 = 96.
RenderingConfig dyadic() {
  RenderingConfig config;
  config.stiffness = 8192.0;
  config.mass = 0.5;
  config.damping_ratio = 0.75;
  return config;
}

const Mat3 kS = Vec3(1.0, 0.5, 0.0).asDiagonal();
const Vec3 kSpring(-4.0, 8.0, 0.0);
const Vec3 kVelocity(0.5, 0.25, -2.0);

/// The rendered force for a tool that does not turn.
Vec3 rendered(const RenderingConfig& config, const Vec3& spring = kSpring, const Mat3& S = kS,
              const Vec3& v = kVelocity) {
  return DampingAndLimits(config).rendered_force(spring, S, {v, S * v});
}

TEST(Damping, IsTwoZetaRootKM) {
  EXPECT_EQ(DampingAndLimits(dyadic()).damping(), 96.0);
  // Thesis A.3: zeta = 0.7 at K = 433731 N/m, M = 0.1 kg.
  RenderingConfig config;
  config.stiffness = 433731.0;
  config.mass = 0.1;
  EXPECT_NEAR(DampingAndLimits(config).damping(), 291.6, 0.05);
}

TEST(Damping, CanBeGivenInsteadOfItsRatio) {
  RenderingConfig config = dyadic();
  config.damping = 12.0;
  EXPECT_EQ(DampingAndLimits(config).damping(), 12.0);
}

TEST(Damping, ActsOnTheNormalVelocitySv) {
  // v_n = S v = (0.5, 0.125, 0).
  EXPECT_EQ(rendered(dyadic()), Vec3(-4.0 - 96 * 0.5, 8.0 - 96 * 0.125, 0.0));
}

TEST(Damping, EqualsTheSumOverContactsOfTheirNormalVelocities) {
  // -B sum c_i <v, u_i> u_i, thesis B.2, written without S.
  Random random(1);
  std::vector<Vec3> gradients(40);
  for (Vec3& u : gradients) u = random.direction();
  ContactBuffer contacts = test::contacts_of(gradients);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < 40; ++i) {
    contacts.weight[i] = random.uniform();
    sum += contacts.weight[i] * kVelocity.dot(gradients[i]) * gradients[i];
  }
  const Vec3 force = rendered(dyadic(), Vec3::Zero(), stiffness_tensor(contacts));
  EXPECT_LE((force + 96 * sum).norm(), 96 * 40 * 8 * kEps * kVelocity.norm());
}

TEST(Damping, ActsOnTheNormalVelocityOfTheContactsWhereItIsGiven) {
  RenderingConfig config = dyadic();
  config.mu_s = 3.0;
  // v_t = (1, 2, 3) - (0.5, 0, 1).
  const ContactVelocity velocity{{1.0, 2.0, 3.0}, {0.5, 0.0, 1.0}};
  const Vec3 force = DampingAndLimits(config).rendered_force(kSpring, kS, velocity);
  EXPECT_EQ(force, Vec3(kSpring - 96 * velocity.normal - 3.0 * Vec3(0.5, 2.0, 2.0)));
  config.max_damping = 24.0;
  EXPECT_EQ(DampingAndLimits(config).rendered_force(kSpring, kS, velocity),
            Vec3(kSpring - 24 * velocity.normal - 3.0 * Vec3(0.5, 2.0, 2.0)));
}

TEST(Friction, IsViscousOnTheTangentialVelocityPlusAShareOfTheSpringForce) {
  RenderingConfig config = dyadic();
  config.damping = 0.0;
  config.mu_s = 3.0;
  // v_t = v - S v = (0, 0.125, -2); |f_spring| = sqrt(80).
  const Vec3 tangential(0.0, 0.125, -2.0);
  EXPECT_EQ(rendered(config), Vec3(kSpring - 3.0 * tangential));
  config.mu_f = 2.0;
  EXPECT_LE((rendered(config) - (kSpring - (3.0 + 2.0 * kSpring.norm()) * tangential)).norm(), 4 * kEps * 100);
  config.mu_s = 0.0;
  EXPECT_LE((rendered(config) - (kSpring - 2.0 * kSpring.norm() * tangential)).norm(), 4 * kEps * 100);
}

TEST(Friction, IsAddedToDamping) {
  RenderingConfig config = dyadic();
  config.mu_s = 3.0;
  EXPECT_EQ(rendered(config), Vec3(-4.0 - 96 * 0.5, 8.0 - 96 * 0.125 - 3 * 0.125, 6.0));
}

TEST(MaxDamping, ScalesTheNormalDampingSoThatItsLargestEigenvalueIsTheLimit) {
  RenderingConfig config = dyadic();
  config.max_damping = 24.0;  // lambda_max(B S) = 96
  EXPECT_EQ(rendered(config), Vec3(-4.0 - 24 * 0.5, 8.0 - 24 * 0.125, 0.0));
}

TEST(MaxDamping, CountsTheStiffestDirectionOfS) {
  RenderingConfig config = dyadic();
  config.max_damping = 24.0;
  const Mat3 S = Vec3(1.0, 4.0, 2.0).asDiagonal();
  const Vec3 force = rendered(config, Vec3::Zero(), S, {1, 1, 1});
  EXPECT_EQ(force, Vec3(-6.0, -24.0, -12.0));
}

TEST(MaxDamping, LeavesSmallerDampingAndFrictionAlone) {
  RenderingConfig config = dyadic();
  config.mu_s = 3.0;
  const Vec3 without = rendered(config);
  config.max_damping = 96.0;
  EXPECT_EQ(rendered(config), without);
  config.max_damping = 24.0;
  EXPECT_EQ(rendered(config).z(), without.z()) << "friction along z";
}

TEST(MaxForce, ScalesTheRenderedForceToItsLength) {
  RenderingConfig config = dyadic();
  config.mu_s = 3.0;
  const Vec3 without = rendered(config);
  config.max_force = 10.0;
  EXPECT_NEAR(rendered(config).norm(), 10.0, 4 * kEps * 10);
  EXPECT_LE((rendered(config).normalized() - without.normalized()).norm(), 4 * kEps);
}

TEST(MaxForce, LeavesShorterForcesAlone) {
  RenderingConfig config = dyadic();
  const Vec3 without = rendered(config);
  config.max_force = without.norm();
  EXPECT_EQ(rendered(config), without);
  config.max_force = 1e9;
  EXPECT_EQ(rendered(config), without);
}

TEST(DampingAndLimits, AToolAtRestFeelsTheSpringsAlone) {
  RenderingConfig config = dyadic();
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  EXPECT_EQ(rendered(config, kSpring, kS, Vec3::Zero()), kSpring);
}

}  // namespace
}  // namespace hapbench::damping_and_limits_test
