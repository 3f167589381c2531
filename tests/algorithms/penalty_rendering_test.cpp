#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <stdexcept>

#include "algorithms/penalty_rendering.hpp"
#include "algorithms/registry.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::penalty_rendering_test {
namespace {

/// Returns a flat tool pressed 0.3 mm into a plane with a point spacing of 0.1 mm.
test::Setting pressed_plane() {
  test::Setting setting;
  setting.points = surface_points(Plane{0.002, 0.0001});
  setting.cell_size = 0.0002;
  setting.pose.position = {0.00001, 0.00002, -0.0003};
  return setting;
}

test::Setting three_springs() {
  test::Setting setting;
  setting.springs = SpringSet{{{1, 0, 0}, {-1, 0, 0}, {0, -1, 0}}, true};
  setting.pose.position = {0.001, -0.002, 0.0};
  return setting;
}

TEST(PenaltyRendering, DepthMaxIsTheDeepestCollidingPointBeforeAnyStage) {
  // The deepest point is merged with shallower points of its cell, and the reduction keeps a single point.
  RenderingConfig config;
  test::Probe plain(pressed_plane(), config);
  const double depth = plain.force_at(pressed_plane().pose).depth_max;
  EXPECT_NEAR(depth, 0.0003, 1e-18);
  config.local_average = true;
  config.reduction = ReductionConfig{};
  test::Probe staged(pressed_plane(), config);
  EXPECT_EQ(staged.force_at(pressed_plane().pose).depth_max, depth);
  EXPECT_EQ(staged.contacts().size(), 1u);
}

TEST(PenaltyRendering, SpringsBringTheirOwnDepths) {
  for (const DepthModelEntry& model : depth_models()) {
    RenderingConfig config;
    config.algorithm = "summation";
    config.depth_model = model.info->name;
    test::Probe probe(three_springs(), config);
    // With x = 1 mm and y = -2 mm, the force is K (-2 x, -y): both springs along +-x push by -K x, and the spring along
    // -y pushes by -K y.
    const Vec3 force = probe.force_at(three_springs().pose).spring;
    EXPECT_LE((force - Vec3(-40.0, 40.0, 0.0)).norm(), 1e-13);
    EXPECT_EQ(probe.contacts().depth[1], -0.001);
  }
}

TEST(PenaltyRendering, WantsTheAngularVelocityForAngularDampingOnly) {
  RenderingConfig config;
  config.angular_velocity_cutoff = 20.0;
  EXPECT_EQ(make_algorithm(config)->angular_velocity_cutoff(), std::nullopt);
  config.angular_damping = true;
  EXPECT_EQ(make_algorithm(config)->angular_velocity_cutoff(), 20.0);
  config.angular_velocity_cutoff.reset();
  EXPECT_EQ(make_algorithm(config)->angular_velocity_cutoff(), std::numeric_limits<double>::infinity());
  config.angular_velocity_cutoff = 5.0;
  config.passivity_controller = true;
  EXPECT_EQ(make_algorithm(config)->angular_velocity_cutoff(), 5.0);
}

TEST(PenaltyRendering, AngularDampingIsThatOfEveryContactAndFrictionThatOfTheirMean) {
  // The tool rotates about y at 2 rad/s, so its velocity at a contact (x, y, z) relative to the tip is (2 z, 0, -2 x).
  // The contacts lie z = 0.3 mm above the tip, with gradients along -z and weights 1 / n. So the mean velocity is v_n =
  // -2 x_mean along z (normal) and v_t = 2 z along x (tangential).
  RenderingConfig config;
  config.algorithm = "mean";
  config.damping = 10.0;
  config.angular_damping = true;
  config.mu_s = 5.0;
  test::Probe probe(pressed_plane(), config);
  const ToolPose pose = pressed_plane().pose;
  const RenderedForce force = probe.force_at(pose, Vec3::Zero(), {0.0, 2.0, 0.0});
  double mean_x = 0.0;
  for (std::size_t i = 0; i < probe.contacts().size(); ++i) mean_x += probe.contacts().x[i] - pose.position.x();
  mean_x /= static_cast<double>(probe.contacts().size());
  const Vec3 expected(-5.0 * 2.0 * 0.0003, 0.0, 10.0 * 2.0 * mean_x);
  EXPECT_LE((force.rendered - force.spring - expected).norm(), 1e-14);
  EXPECT_NE(mean_x, 0.0);
}

TEST(PenaltyRendering, CountsIterationsAndDroppedPointsUntilReset) {
  RenderingConfig config;
  config.iterations = 4;
  config.reduction = ReductionConfig{0.995, 1, {}};
  test::Probe probe(three_springs(), config);
  for (int step = 0; step < 3; ++step) probe.force_at(three_springs().pose);
  EXPECT_EQ(probe.algorithm().work().iterations, 12u);
  EXPECT_EQ(probe.algorithm().work().points_dropped, 6u);
  probe.algorithm().reset();
  EXPECT_EQ(probe.algorithm().work().iterations, 0u);
  EXPECT_EQ(probe.algorithm().work().points_dropped, 0u);
}

TEST(PenaltyRendering, LocalAverageNeedsAShellWithAGrid) {
  RenderingConfig config;
  config.local_average = true;
  EXPECT_THROW(test::Probe(three_springs(), config), std::invalid_argument);
  test::Setting without_grid = pressed_plane();
  without_grid.cell_size = 0.0;
  EXPECT_THROW(test::Probe(without_grid, config), std::invalid_argument);
}

// Tests the velocity that a rotating tool adds (ForceLaw::turning_velocity).

constexpr const char* kWeighted[] = {"summation", "mean", "shaped_stiffness", "tandpasta", "exact_shaping"};

ToolState turning_tool(Random& random) {
  return {{random.direction(), Vec3::UnitZ()}, Vec3::Zero(), 3.0 * random.direction()};
}

/// Draws random gradients at random points within 1 cm of the tip for the law `name`; calls f(law, S, contacts, tool).
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

/// Returns <omega x r_i, u_i> for all contacts.
Eigen::VectorXd normal_speeds(const ContactBuffer& contacts, const ToolState& tool) {
  Eigen::VectorXd speeds(static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 velocity = tool.angular_velocity.cross(contacts.point(i) - tool.pose.position);
    speeds[static_cast<Eigen::Index>(i)] = velocity.dot(contacts.gradient(i));
  }
  return speeds;
}

/// Returns the rounding error of a sum of n <= 200 weighted velocities of at most 3 cm/s, added in another order.
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
        // The default is K_vc = K.
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
}  // namespace hapbench::penalty_rendering_test
