// What every algorithm must answer where the answer is known.
#include "tests/algorithms/every_algorithm/algorithm_on_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "sim/contact/stiffness_tensor.hpp"

namespace hapbench::answer_test {
namespace {

class Answer : public test::AlgorithmOnSceneTest {};
HAPBENCH_FOR_EVERY_ALGORITHM(Answer, test::always);

TEST_P(Answer, HasTheKnownDirectionAndIsBoundedByTheSumOfAllSprings) {
  test::Probe probe(setting, config);
  Vec3 force;
  // A proxy that starts inside leaves slowly.
  for (int step = 0; step < 100; ++step) force = probe.force_at(setting.pose).spring;
  ASSERT_TRUE(force.allFinite());
  const test::Answer answer = scene().answer();
  const double rounding = test::kAnyLawsRounding * magnitude;
  if (answer.only_in_plane) {
    EXPECT_EQ(force.z(), 0.0);
    EXPECT_GT(force.norm(), 0.0);
    return;
  }
  const double along = force.dot(answer.direction);
  EXPECT_LE((force - along * answer.direction).norm(), rounding);
  EXPECT_LE(along, magnitude);
  if (answer.direction == Vec3::Zero()) return;
  if (answer.may_vanish) {
    EXPECT_GE(along, 0.0);
  } else {
    EXPECT_GT(along, 0.001 * magnitude / static_cast<double>(probe.contacts().size()));
  }
}

/// Where a scene names the algorithm's force. Others (new algorithms, scenes of many points) are only bounded, above.
class ExactAnswer : public test::AlgorithmOnSceneTest {};
HAPBENCH_FOR_EVERY_ALGORITHM(ExactAnswer, [](const test::AlgorithmOnScene& instance) {
  return instance.scene->answer().spring_over_K.contains(instance.algorithm);
});

TEST_P(ExactAnswer, IsTheForceOfTheLaw) {
  const test::Answer answer = scene().answer();
  const Vec3 expected = config.stiffness * answer.spring_over_K.at(GetParam().algorithm) * answer.direction;
  const Vec3 force = test::Probe(setting, config).force_at(setting.pose).spring;
  // A handful of springs: sums and solves of numbers of the order of the depths, the residual of exact_shaping 1e-14.
  EXPECT_LE((force - expected).norm(), 1e-13 * magnitude)
      << force.transpose() << " instead of " << expected.transpose();
}

TEST_P(Answer, VanishesWithoutContactOrAtNaturalLength) {
  test::Probe probe(setting, config);
  probe.force_at(setting.pose);
  const RenderedForce force = probe.force_at({scene().position_without_force, setting.pose.axis});
  EXPECT_EQ(force.spring, Vec3(0, 0, 0));
  EXPECT_EQ(force.rendered, Vec3(0, 0, 0));
  EXPECT_EQ(force.depth_max, 0.0);
}

TEST_P(Answer, AToolAtRestFeelsTheSpringsAlone) {
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  const RenderedForce force = test::Probe(setting, config).force_at(setting.pose);
  EXPECT_EQ(force.rendered, force.spring);
}

TEST_P(Answer, StiffnessTensorIsSymmetricAndPositiveSemidefinite) {
  const Mat3 S = test::Probe(setting, config).force_at(setting.pose).S;
  ASSERT_TRUE(S.allFinite());
  EXPECT_EQ(S, S.transpose());
  // Sums of c u u^T with c >= 0, rounded.
  EXPECT_LE(lambda_max(-S), 1e-14 * (1.0 + S.norm()));
}

TEST_P(Answer, DampingAndFrictionNeverDriveTheTool) {
  Random random(1);
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  test::Probe probe(setting, config);
  const RenderedForce at_rest = probe.force_at(setting.pose);
  // Friction is on v - S v: it brakes where S <= 1, which laws that add springs up do not promise.
  if (lambda_max(at_rest.S) > 1.0 + 1e-12) config.mu_s = config.mu_f = 0.0;
  test::Probe braked(setting, config);
  for (int i = 0; i < 20; ++i) {
    const Vec3 velocity = random.direction();
    const Vec3 drag = braked.force_at(setting.pose, velocity).rendered - at_rest.rendered;
    EXPECT_LE(drag.dot(velocity), 1e-12 * (1.0 + drag.norm() + at_rest.rendered.norm()));
  }
}

TEST_P(Answer, ATurnIsFeltWithAngularDampingOnly) {
  const Vec3 velocity(0.02, -0.03, 0.01), turn(0.5, -1.0, 2.0);
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  const Vec3 without = test::Probe(setting, config).force_at(setting.pose, velocity).rendered;
  EXPECT_EQ(test::Probe(setting, config).force_at(setting.pose, velocity, turn).rendered, without);
  config.angular_damping = true;
  EXPECT_EQ(test::Probe(setting, config).force_at(setting.pose, velocity).rendered, without);
  test::Probe probe(setting, config);
  const Vec3 with = probe.force_at(setting.pose, velocity, turn).rendered;
  // Springs are attached to the tip, which does not move when the tool turns; and tandpasta may leave no weight at all.
  const auto& c = probe.contacts().weight;
  const bool feels_nothing =
      setting.springs || std::all_of(c.begin(), c.end(), [](double weight) { return weight == 0; });
  EXPECT_EQ(with == without, feels_nothing);
}

/// One contact, off the tip.
TEST(AngularDamping, InOneContactATurnIsTheVelocityOfTheToolThere) {
  const Vec3 arm(0.0003, 0.0002, 0.004), turn(0.5, -1.0, 2.0), velocity(0.02, -0.03, 0.01);
  test::Setting setting;
  setting.points = {{arm, Vec3(1.0, 2.0, -2.0) / 3.0}};
  for (const AlgorithmEntry& algorithm : algorithms()) {
    SCOPED_TRACE(algorithm.info->name);
    // What turns is the proxy, and it is held at another place of the tool; a test of its own says so.
    if (std::string_view(algorithm.info->name) == "proxy") continue;
    RenderingConfig config;
    config.algorithm = algorithm.info->name;
    config.angular_damping = true;
    config.mu_s = 5.0;
    config.mu_f = 10.0;
    test::Probe turned(setting, config), moved(setting, config);
    const Vec3 force = turned.force_at({}, velocity, turn).rendered;
    const Vec3 expected = moved.force_at({}, velocity + turn.cross(arm)).rendered;
    EXPECT_LE((force - expected).norm(), test::kAnyLawsRounding * expected.norm());
    EXPECT_GT((force - moved.force_at({}, velocity).rendered).norm(), 0.001 * expected.norm());
  }
}

}  // namespace
}  // namespace hapbench::answer_test
