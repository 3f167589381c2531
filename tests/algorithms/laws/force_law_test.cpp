#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

/// The velocity that a turning tool adds (ForceLaw::turning_velocity).
namespace hapbench::force_law_test {
namespace {

constexpr const char* kWeighted[] = {"summation", "mean", "shaped_stiffness", "tandpasta", "exact_shaping"};

ToolState turning_tool(Random& random) {
  return {{random.direction(), Vec3::UnitZ()}, Vec3::Zero(), 3.0 * random.direction()};
}

/// Random gradients at random points within 1 cm of the tip, under the law `name`; calls f(law, S, contacts, tool).
template <class F>
void for_random_contacts(const char* name, F f) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    std::vector<Vec3> gradients(test::random_size(random, 200));
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer contacts = test::contacts_of(gradients, test::random_depths(random, gradients.size()));
    const ToolState tool = turning_tool(random);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const Vec3 point = tool.pose.position + 0.01 * random.uniform() * random.direction();
      contacts.x[k] = point.x();
      contacts.y[k] = point.y();
      contacts.z[k] = point.z();
    }
    const auto law = make_law(name, {});
    law->prepare(contacts.capacity());
    const Mat3 S = law->evaluate(contacts).S;
    f(*law, S, contacts, tool);
  }
}

/// <omega x r_i, u_i> of all contacts.
Eigen::VectorXd normal_speeds(const ContactBuffer& contacts, const ToolState& tool) {
  Eigen::VectorXd speeds(static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 velocity = tool.angular_velocity.cross(contacts.point(i) - tool.pose.position);
    speeds[static_cast<Eigen::Index>(i)] = velocity.dot(contacts.gradient(i));
  }
  return speeds;
}

/// Sums of n <= 200 velocities of at most 3 cm/s times a weight, in another order.
double rounding(const Eigen::VectorXd& c) {
  return 200 * 8 * std::numeric_limits<double>::epsilon() * 0.03 * (1.0 + c.sum());
}

TEST(TurningVelocity, OfWeightedLawsIsTheSumOverTheirContacts) {
  for (const char* name : kWeighted) {
    for_random_contacts(name,
                        [](const ForceLaw& law, const Mat3& S, const ContactBuffer& contacts, const ToolState& tool) {
                          const Eigen::VectorXd c = test::weights(contacts);
                          const Vec3 expected = test::Dense(contacts).U * c.cwiseProduct(normal_speeds(contacts, tool));
                          ASSERT_LE((law.turning_velocity(contacts, S, tool) - expected).norm(), rounding(c));
                        });
  }
}

TEST(TurningVelocity, OfVirtualCouplingPassesTheCouplingAsDepthsDo) {
  for_random_contacts(
      "virtual_coupling", [](const ForceLaw& law, const Mat3& S, const ContactBuffer& contacts, const ToolState& tool) {
        // K_vc = K.
        const test::Dense dense(contacts);
        const Mat3 series = (Mat3::Identity() + dense.U * dense.U.transpose()).inverse();
        const Vec3 expected = series * (dense.U * normal_speeds(contacts, tool));
        ASSERT_LE((law.turning_velocity(contacts, S, tool) - expected).norm(), rounding(test::weights(contacts)));
      });
}

TEST(TurningVelocity, OfOriginalAveragingIsThatOfTheMiddleOfTheContactsAlongTheMeanGradient) {
  for_random_contacts("original_averaging", [](const ForceLaw& law, const Mat3& S, const ContactBuffer& contacts,
                                               const ToolState& tool) {
    Vec3 middle = Vec3::Zero();
    for (std::size_t i = 0; i < contacts.size(); ++i) middle += contacts.point(i) - tool.pose.position;
    middle /= static_cast<double>(contacts.size());
    const Vec3 u = gradient_sum(contacts).normalized();
    const Vec3 expected = u * u.dot(tool.angular_velocity.cross(middle));
    ASSERT_LE((law.turning_velocity(contacts, S, tool) - expected).norm(), rounding(Eigen::VectorXd::Ones(1)));
  });
}

TEST(MeanArm, IsWeighedAndZeroWithoutWeights) {
  ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY()});
  contacts.x[1] = 4.0;
  contacts.weight[0] = 0.25;
  contacts.weight[1] = 0.75;
  EXPECT_EQ(mean_arm(contacts, {1.0, 0.0, 0.0}), Vec3(2.0, 0.0, 0.0));
  set_weights(contacts, 0.0);
  EXPECT_EQ(mean_arm(contacts, {1.0, 0.0, 0.0}), Vec3(0.0, 0.0, 0.0));
}

}  // namespace
}  // namespace hapbench::force_law_test
