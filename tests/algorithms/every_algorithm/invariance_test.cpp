// What must not change a force, or only as the change itself says.
#include "tests/algorithms/every_algorithm/algorithm_on_scene.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::invariance_test {
namespace {

class Invariance : public test::AlgorithmOnSceneTest {
 protected:
  void SetUp() override {
    // With everything that can act on a moving tool.
    config.mu_s = 5.0;
    config.mu_f = 10.0;
  }
  double rounding() const { return test::kAnyLawsRounding * magnitude; }
  /// Of a rendered force: B S v and friction add to the springs; S is as accurate as single weights.
  double rounding_in_motion(const RenderedForce& force) const {
    return 4 * rounding() + test::kAnyLawsRounding * (force.rendered - force.spring).norm();
  }

  const Vec3 velocity{0.02, -0.03, 0.01};
};
HAPBENCH_FOR_EVERY_ALGORITHM(Invariance, test::always);

class RigidMotion : public Invariance {
 protected:
  /// Of a slot that is too narrow for the tool the proxy makes a compromise, whose 3x3 system has the condition
  /// n / epsilon = 640 / 1e-6, times 2e-16 for each of its entries.
  static constexpr double kCompromiseRounding = 640 / 1e-6 * 2e-16;
  bool is_proxy() const { return GetParam().algorithm == "proxy"; }
  double rounding() const {
    return Invariance::rounding() + (is_proxy() ? kCompromiseRounding * config.stiffness * setting.tool.radius() : 0.0);
  }
  double rounding_of_S() const { return is_proxy() ? 4 * kCompromiseRounding : test::kAnyLawsRounding; }
  double rounding_in_motion(const RenderedForce& force) const {
    return 4 * rounding() + rounding_of_S() * (force.rendered - force.spring).norm();
  }
};
/// Neither where the tool exactly touches, nor for an algorithm with directions of its own (merged_shaping, whose test
/// has the turns that it allows), nor for a proxy whose peg is too wide for the hole: a planar scene is thin,
/// and rounding decides by which side the peg slips out of its plane.
HAPBENCH_FOR_EVERY_ALGORITHM(RigidMotion, [](const test::AlgorithmOnScene& instance) {
  const bool slips = instance.algorithm == "proxy" && instance.scene->name.starts_with("tilted_peg");
  return !instance.scene->touches && !slips && instance.algorithm != "merged_shaping";
});

class FarPoints : public Invariance {};
HAPBENCH_FOR_EVERY_ALGORITHM(FarPoints,
                             [](const test::AlgorithmOnScene& instance) { return !instance.scene->setting().springs; });

TEST_P(RigidMotion, OfTheWholeSceneTurnsForceAndTorque) {
  const auto torque_of = [](test::Probe& probe, const ToolPose& pose) {
    return probe.algorithm().spring_state({pose, Vec3::Zero()}, probe.contacts()).moment;
  };
  test::Probe here(setting, config);
  const RenderedForce original = here.force_at(setting.pose, velocity);
  const Vec3 torque = torque_of(here, setting.pose);
  Random random(1);
  for (int i = 0; i < 10; ++i) {
    const Mat3 R = test::random_rotation(random);
    // Springs are attached to the origin and can only be turned with it.
    const Vec3 t = setting.springs ? Vec3(0, 0, 0) : Vec3(0.1 * random.direction());
    const test::Setting there = test::moved(setting, R, t);
    test::Probe probe(there, config);
    const RenderedForce force = probe.force_at(there.pose, R * velocity);
    // Of points that hold a proxy equally well, as those of a flat, rounding decides which do.
    if (!is_proxy()) {
      ASSERT_LE((torque_of(probe, there.pose) - R * torque).norm(), rounding() * there.tool.reach());
    }
    ASSERT_LE((force.spring - R * original.spring).norm(), rounding());
    ASSERT_LE((force.rendered - R * original.rendered).norm(), rounding_in_motion(original));
    ASSERT_LE((force.S - R * original.S * R.transpose()).norm(), rounding_of_S() * (1.0 + original.S.norm()));
  }
}

/// What the algorithm has of its own in newtons, such as a force at which it saturates, belongs to the scale.
RenderingConfig with_forces_scaled(RenderingConfig config, double s) {
  for (const OwnParameter& own : find_algorithm(config.algorithm)->own_parameters) {
    if (std::string_view(own.range.unit) == "N")
      config.parameters[config.algorithm][own.name] = s * own_value(config, config.algorithm.c_str(), own);
  }
  return config;
}

TEST_P(Invariance, LengthsScaleTheSpringForce) {
  // Powers of four scale every product, sum and root without rounding: the force is the same to the bit.
  const Vec3 original = test::Probe(setting, config).force_at(setting.pose).spring;
  for (const double s : {4.0, 0.25, 1024.0}) {
    const test::Setting scaled = test::scaled(setting, s);
    EXPECT_EQ(test::Probe(scaled, with_forces_scaled(config, s)).force_at(scaled.pose).spring, s * original)
        << "s = " << s;
  }
}

TEST_P(Invariance, StiffnessScalesTheSpringForce) {
  const Vec3 original = test::Probe(setting, config).force_at(setting.pose).spring;
  for (const double s : {4.0, 0.25, 1024.0}) {
    RenderingConfig stiffer = with_forces_scaled(config, s);
    stiffer.stiffness *= s;
    EXPECT_EQ(test::Probe(setting, stiffer).force_at(setting.pose).spring, s * original) << "s = " << s;
  }
}

TEST_P(Invariance, TheOrderOfThePointsDoesNotMatter) {
  const RenderedForce original = test::Probe(setting, config).force_at(setting.pose, velocity);
  Random random(2);
  for (int i = 0; i < 10; ++i) {
    const test::Setting permuted = test::permuted(setting, random);
    const RenderedForce force = test::Probe(permuted, config).force_at(permuted.pose, velocity);
    ASSERT_LE((force.spring - original.spring).norm(), rounding());
    ASSERT_LE((force.rendered - original.rendered).norm(), rounding_in_motion(original));
  }
}

TEST_P(FarPoints, DoNotMatter) {
  const RenderedForce original = test::Probe(setting, config).force_at(setting.pose, velocity);
  // At the end, so that the order in which the others are added up stays.
  for (int i = 0; i < 20; ++i) setting.points.push_back({{1.0, 0.1 * i, 0.0}, Vec3::UnitY()});
  const RenderedForce force = test::Probe(setting, config).force_at(setting.pose, velocity);
  EXPECT_EQ(force.spring, original.spring);
  EXPECT_EQ(force.rendered, original.rendered);
  EXPECT_EQ(force.S, original.S);
}

}  // namespace
}  // namespace hapbench::invariance_test
