#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "results/summary/allocations.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::every_algorithm_test {
namespace {

using test::cases;

// Tests every registered algorithm in every analytic scene. These tests include a new algorithm once it is in the
// registry, and a new scene once it is in setting.cpp.

struct AlgorithmOnScene {
  std::string_view algorithm;
  const test::AnalyticScene* scene;

  std::string name() const { return std::string(algorithm) + "_on_" + std::string(scene->name); }
};

void PrintTo(const AlgorithmOnScene& instance, std::ostream* out) {
  *out << instance.name();
}

/// Returns the instances (algorithm and scene) for which `applies` is true.
template <class Applies>
std::vector<AlgorithmOnScene> algorithms_on_scenes(Applies applies) {
  std::vector<AlgorithmOnScene> instances;
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const test::AnalyticScene& scene : test::analytic_scenes()) {
      const AlgorithmOnScene instance{algorithm.info->name, &scene};
      if (applies(instance)) instances.push_back(instance);
    }
  }
  return instances;
}

bool always(const AlgorithmOnScene&) {
  return true;
}

/// Holds the instance's setting and configuration, built once for each test.
class AlgorithmOnSceneTest : public testing::TestWithParam<AlgorithmOnScene> {
 protected:
  const test::AnalyticScene& scene() const { return *GetParam().scene; }

  test::Setting setting = GetParam().scene->setting();
  RenderingConfig config = test::config_for(GetParam().algorithm, *GetParam().scene);
  /// Scale of rounding errors of a force [N]: the sum of all penalty forces, plus the force at a depth of 1 um. The
  /// second term accounts for the rounding of coordinates, which does not become smaller with the depths.
  double magnitude = config.stiffness * (test::total_depth(setting, config) + 1e-6);
};

/// Largest relative change of any law's force through rounding, if the same contacts are given in another order or
/// frame. Coordinates and normals change by a few 1e-16 of their size, which is 1e-12 of a depth of 0.1 mm.
/// exact_shaping amplifies rounding most: the error of its weights is 2e-16 divided by its epsilon of 1e-6.
constexpr double kAnyLawsRounding = 1e-9;

/// Instantiates a suite derived from AlgorithmOnSceneTest. Its tests have names such as `summation_on_single_spring`.
#define HAPBENCH_FOR_EVERY_ALGORITHM(suite, applies)                                       \
  INSTANTIATE_TEST_SUITE_P(Every, suite, testing::ValuesIn(algorithms_on_scenes(applies)), \
                           [](const auto& instance) { return instance.param.name(); })

class Answer : public AlgorithmOnSceneTest {};
HAPBENCH_FOR_EVERY_ALGORITHM(Answer, always);

TEST_P(Answer, HasTheKnownDirectionAndIsBoundedByTheSumOfAllSprings) {
  test::Probe probe(setting, config);
  Vec3 force;
  // Take 100 steps, because a proxy that starts inside leaves slowly.
  for (int step = 0; step < 100; ++step) force = probe.force_at(setting.pose).spring;
  ASSERT_TRUE(force.allFinite());
  const test::Answer answer = scene().answer();
  const double rounding = kAnyLawsRounding * magnitude;
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

/// Instances (algorithm and scene) for which the force is known. For other instances, such as new algorithms or scenes
/// with many points, only a bound is known.
class ExactAnswer : public AlgorithmOnSceneTest {};
HAPBENCH_FOR_EVERY_ALGORITHM(ExactAnswer, [](const AlgorithmOnScene& instance) {
  return instance.scene->answer().spring_over_K.contains(instance.algorithm);
});

TEST_P(ExactAnswer, IsTheForceOfTheLaw) {
  const test::Answer answer = scene().answer();
  const Vec3 expected = config.stiffness * answer.spring_over_K.at(GetParam().algorithm) * answer.direction;
  const Vec3 force = test::Probe(setting, config).force_at(setting.pose).spring;
  // The laws add a few numbers of the size of the depths, or solve equations with a few such coefficients.
  // exact_shaping solves its equations up to an error of 1e-14.
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
  // S is a sum of terms c u u^T with c >= 0. Up to rounding, such a sum is positive semidefinite.
  EXPECT_LE(lambda_max(-S), 1e-14 * (1.0 + S.norm()));
}

TEST_P(Answer, DampingAndFrictionNeverDriveTheTool) {
  Random random(1);
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  test::Probe probe(setting, config);
  const RenderedForce at_rest = probe.force_at(setting.pose);
  // Friction is proportional to v - S v. It dissipates energy if no eigenvalue of S exceeds 1. Laws that add the forces
  // of all springs may exceed 1, so friction is switched off.
  if (lambda_max(at_rest.S) > 1.0 + 1e-12) config.mu_s = config.mu_f = 0.0;
  test::Probe braked(setting, config);
  for (int i = 0; i < 20; ++i) {
    const Vec3 velocity = random.direction();
    const Vec3 drag = braked.force_at(setting.pose, velocity).rendered - at_rest.rendered;
    EXPECT_LE(drag.dot(velocity), 1e-12 * (1.0 + drag.norm() + at_rest.rendered.norm()));
  }
}

TEST_P(Answer, DryFrictionAndDampingThatGrowsWithDepthOpposeAMotionFromRest) {
  config.dry_friction = DryFrictionConfig{};
  config.hunt_crossley = 2.0;
  const Vec3 at_rest = test::Probe(setting, config).force_at(setting.pose, Vec3::Zero()).rendered;
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Vec3 velocity = 0.1 * random.direction();
    const Vec3 drag = test::Probe(setting, config).force_at(setting.pose, velocity).rendered - at_rest;
    EXPECT_LE(drag.dot(velocity), 1e-12 * (1.0 + drag.norm() + at_rest.norm()));
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
  // The rotation does not change the force in two cases: springs of a SpringSet are attached to the tip, which does not
  // move, and tandpasta may give every contact the weight zero.
  const auto& c = probe.contacts().weight;
  const bool feels_nothing =
      setting.springs || std::all_of(c.begin(), c.end(), [](double weight) { return weight == 0; });
  EXPECT_EQ(with == without, feels_nothing);
}

/// Checks the force of a single contact at the position `arm` relative to the tip centre. A rotating tool must get the
/// same force as a tool that does not rotate and moves with the velocity that the rotating tool has at the contact.
TEST(AngularDamping, InOneContactATurnIsTheVelocityOfTheToolThere) {
  const Vec3 arm(0.0003, 0.0002, 0.004), turn(0.5, -1.0, 2.0), velocity(0.02, -0.03, 0.01);
  test::Setting setting;
  setting.points = {{arm, Vec3(1.0, 2.0, -2.0) / 3.0}};
  for (const AlgorithmEntry& algorithm : algorithms()) {
    SCOPED_TRACE(algorithm.info->name);
    // Skip the proxy, because it is held at another position than the tool. proxy_test.cpp tests its angular damping.
    if (std::string_view(algorithm.info->name) == "proxy") continue;
    RenderingConfig config;
    config.algorithm = algorithm.info->name;
    config.angular_damping = true;
    config.mu_s = 5.0;
    config.mu_f = 10.0;
    test::Probe turned(setting, config), moved(setting, config);
    const Vec3 force = turned.force_at({}, velocity, turn).rendered;
    const Vec3 expected = moved.force_at({}, velocity + turn.cross(arm)).rendered;
    EXPECT_LE((force - expected).norm(), kAnyLawsRounding * expected.norm());
    EXPECT_GT((force - moved.force_at({}, velocity).rendered).norm(), 0.001 * expected.norm());
  }
}

class Invariance : public AlgorithmOnSceneTest {
 protected:
  void SetUp() override {
    // Enable all forces that can act on a moving tool.
    config.mu_s = 5.0;
    config.mu_f = 10.0;
  }
  double rounding() const { return kAnyLawsRounding * magnitude; }
  /// Returns the rounding error of a rendered force: the error of the spring force plus the error of the damping B S v
  /// and of the friction. S has the relative error of a single weight.
  double rounding_in_motion(const RenderedForce& force) const {
    return 4 * rounding() + kAnyLawsRounding * (force.rendered - force.spring).norm();
  }

  const Vec3 velocity{0.02, -0.03, 0.01};
};
HAPBENCH_FOR_EVERY_ALGORITHM(Invariance, always);

class RigidMotion : public Invariance {
 protected:
  /// In a slot that is too narrow for the tool, no position of the proxy satisfies all contacts, and the proxy takes
  /// the least-squares compromise. The 3x3 system of the compromise has the condition number n / epsilon = 640 / 1e-6
  /// for n = 640 contacts. The rounding error is the condition number times the rounding 2e-16 of the entries.
  static constexpr double kCompromiseRounding = 640 / 1e-6 * 2e-16;
  bool is_proxy() const { return GetParam().algorithm == "proxy"; }
  double rounding() const {
    return Invariance::rounding() + (is_proxy() ? kCompromiseRounding * config.stiffness * setting.tool.radius() : 0.0);
  }
  double rounding_of_S() const { return is_proxy() ? 4 * kCompromiseRounding : kAnyLawsRounding; }
  double rounding_in_motion(const RenderedForce& force) const {
    return 4 * rounding() + rounding_of_S() * (force.rendered - force.spring).norm();
  }
};
/// Excludes scenes in which a point lies exactly on the tool's surface, and merged_shaping, which has preferred
/// directions and its own test. Also excludes the proxy in the planar scenes whose peg is too wide for the hole,
/// because rounding decides to which side the proxy slips out of the plane.
HAPBENCH_FOR_EVERY_ALGORITHM(RigidMotion, [](const AlgorithmOnScene& instance) {
  const bool slips = instance.algorithm == "proxy" && instance.scene->name.starts_with("tilted_peg");
  return !instance.scene->touches && !slips && instance.algorithm != "merged_shaping";
});

class FarPoints : public Invariance {};
HAPBENCH_FOR_EVERY_ALGORITHM(FarPoints,
                             [](const AlgorithmOnScene& instance) { return !instance.scene->setting().springs; });

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
    // Springs are attached to the origin, so they can be rotated but not translated.
    const Vec3 t = setting.springs ? Vec3(0, 0, 0) : Vec3(0.1 * random.direction());
    const test::Setting there = test::moved(setting, R, t);
    test::Probe probe(there, config);
    const RenderedForce force = probe.force_at(there.pose, R * velocity);
    // Rounding decides which of several equivalent points, such as points of a flat face, hold the proxy.
    if (!is_proxy()) {
      ASSERT_LE((torque_of(probe, there.pose) - R * torque).norm(), rounding() * there.tool.reach());
    }
    ASSERT_LE((force.spring - R * original.spring).norm(), rounding());
    ASSERT_LE((force.rendered - R * original.rendered).norm(), rounding_in_motion(original));
    ASSERT_LE((force.S - R * original.S * R.transpose()).norm(), rounding_of_S() * (1.0 + original.S.norm()));
  }
}

/// Returns the configuration in which the algorithm's own parameters in newtons, such as a saturation force, are
/// multiplied by s.
RenderingConfig with_forces_scaled(RenderingConfig config, double s) {
  for (const AlgorithmParameter& own : find_algorithm(config.algorithm)->algorithm_parameters) {
    if (std::string_view(own.range.unit) == "N")
      config.parameters[config.algorithm][own.name] = s * parameter_value(config, config.algorithm.c_str(), own);
  }
  return config;
}

TEST_P(Invariance, LengthsScaleTheSpringForce) {
  // Scaling by powers of four rounds no product, sum or root, so the scaled force is exact.
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
  // Append the points, so that the order of summation of the other points does not change.
  for (int i = 0; i < 20; ++i) setting.points.push_back({{1.0, 0.1 * i, 0.0}, Vec3::UnitY()});
  const RenderedForce force = test::Probe(setting, config).force_at(setting.pose, velocity);
  EXPECT_EQ(force.spring, original.spring);
  EXPECT_EQ(force.rendered, original.rendered);
  EXPECT_EQ(force.S, original.S);
}

constexpr std::uint64_t kSteps = 200;

class Run : public AlgorithmOnSceneTest {};
HAPBENCH_FOR_EVERY_ALGORITHM(Run, always);

TEST_P(Run, StaysFinite) {
  test::Recorder recorder(true);
  Simulation simulation(test::free_run_config(setting, config, kSteps), test::free_run(setting, config), {&recorder});
  EXPECT_EQ(simulation.run().ending, Ending::completed);
  for (const StepRecord& row : recorder.rows) {
    ASSERT_TRUE(row.force.rendered.allFinite());
    ASSERT_TRUE(row.force.S.allFinite());
    ASSERT_TRUE(std::isfinite(row.ratio.min) && std::isfinite(row.ratio.max));
    // No law renders more contacts than the colliding points. The proxy is an exception: points that the tool does not
    // touch may hold the proxy.
    if (GetParam().algorithm != "proxy") {
      ASSERT_LE(recorder.rendered[row.step], row.colliding);
    }
  }
}

TEST_P(Run, IsTheSameToTheBitAfterResetAndInAnotherObject) {
  test::HashingObserver hash;
  Simulation simulation(test::free_run_config(setting, config, kSteps), test::free_run(setting, config), {&hash});
  simulation.run();
  const std::uint64_t first = hash.value();

  hash.clear();
  simulation.reset();
  simulation.run();
  EXPECT_EQ(hash.value(), first);

  hash.clear();
  Simulation(test::free_run_config(setting, config, kSteps), test::free_run(setting, config), {&hash}).run();
  EXPECT_EQ(hash.value(), first);
}

TEST_P(Run, WithEveryStageIsTheSameToTheBitAfterReset) {
  config.reduction = ReductionConfig{0.995, 3, 42};
  config.local_average = !setting.springs;
  config.passivity_controller = true;
  test::HashingObserver hash;
  Simulation simulation(test::free_run_config(setting, config, kSteps), test::free_run(setting, config), {&hash});
  simulation.run();
  const std::uint64_t first = hash.value();
  const AlgorithmWork work = simulation.algorithm().work();
  hash.clear();
  simulation.reset();
  simulation.run();
  EXPECT_EQ(hash.value(), first);
  EXPECT_EQ(simulation.algorithm().work().points_dropped, work.points_dropped);
  EXPECT_EQ(simulation.algorithm().work().steps_controlled, work.steps_controlled);
}

// Tests depth models and algorithms with mesh tools, which are not solids of revolution.

constexpr double kSpacing = 0.0001;

/// Returns a drill with 32 sides, a sphere, a box and a concave cup. The largest width of each is 1 mm.
const std::vector<std::shared_ptr<const MeshTool>>& tools() {
  static const auto all = [] {
    std::vector<std::shared_ptr<const MeshTool>> made;
    TriangleSoup box = test::cube(0.5, {0, 0, 0.5});
    for (Vec3& v : box.vertices) v = v.cwiseProduct(Vec3(0.0006, 0.001, 0.002));
    for (const TriangleSoup& soup :
         {test::cylinder_mesh(0.0005, 0.003, 32), test::scaled(test::sphere(1.0, 3), 0.0005, {0, 0, 0.0005}), box,
          test::scaled(test::cup(24), 0.0005)}) {
      made.push_back(std::make_shared<MeshTool>(test::grid_of(soup, 0.00004)));
    }
    return made;
  }();
  return all;
}

class MeshToolInEveryAlgorithm : public testing::TestWithParam<AlgorithmEntry> {};
INSTANTIATE_TEST_SUITE_P(Registered, MeshToolInEveryAlgorithm,
                         testing::ValuesIn(algorithms().begin(), algorithms().end()),
                         [](const auto& entry) { return std::string(entry.param.info->name); });

TEST_P(MeshToolInEveryAlgorithm, IsPushedOutOfAPlaneWithoutAllocating) {
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  for (const auto& tool : tools()) {
    for (const DepthModelEntry& model : depth_models()) {
      RenderingConfig config;
      config.algorithm = GetParam().info->name;
      if (GetParam().fixed_depth_model.empty()) config.depth_model = model.info->name;
      ShellSource source(shell, *tool, make_contact_query(shell, *tool, Skips::on), make_depth_model(config));
      ContactBuffer contacts(source.capacity());
      const auto algorithm = make_algorithm(config);
      algorithm->prepare({source.capacity(), tool.get(), &shell});
      algorithm->reset();
      RenderedForce force;
      const AllocationCount allocations;
      for (int k = 0; k < 20; ++k) {
        const ToolPose pose{{0.00002, -0.00001, 0.0001 - 0.000007 * k}, Vec3(0.05, 0.02, -1.0).normalized(), 0.1 * k};
        source.contacts_at(pose, contacts);
        algorithm->compute({pose, Vec3::Zero()}, contacts, force);
        ASSERT_TRUE(force.spring.allFinite());
      }
      EXPECT_EQ(allocations.value(), 0u);
      // The tools lean by 3 degrees and edges are near, so some springs push sideways, but their sum points up. The
      // depths stay below 75 um, half the thickness of the bottom of the cup: from deeper points, the shortest exit
      // would lead into the cup.
      EXPECT_GT(force.spring.z(), 0.0) << model.info->name;
    }
  }
}

TEST(Proxy, KeepsEveryPointOutOfConvexMeshes) {
  Random random(3);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  ContactBuffer all(shell.size());
  for (std::size_t i = 0; i < shell.size(); ++i) {
    all.push(static_cast<std::uint32_t>(i), shell.point(i).position, shell.point(i).normal);
  }
  RenderingConfig config;
  config.algorithm = "proxy";
  for (const auto& tool : tools()) {
    if (!tool->convex()) continue;
    ShellSource source(shell, *tool, make_contact_query(shell, *tool, Skips::on), make_depth_model(config));
    ContactBuffer contacts(source.capacity());
    const auto proxy = make_algorithm(config);
    proxy->prepare({source.capacity(), tool.get(), &shell});
    for (std::size_t run = 0; run < cases(20); ++run) {
      // Lower the tool by 50 um in each step, with an axis that leans by at most 30 degrees.
      const Vec3 axis = (Vec3(0, 0, -1) + 0.5 * random.direction()).normalized();
      ToolPose pose{{0.0, 0.0, 0.001}, axis, random.uniform(-3.0, 3.0)};
      proxy->reset();
      RenderedForce force;
      for (int k = 0; k < 40; ++k) {
        source.contacts_at(pose, contacts);
        proxy->compute({pose, Vec3::Zero()}, contacts, force);
        tool->shortest_depths({pose.position + force.spring / config.stiffness, axis, pose.roll}, all);
        ASSERT_LE(*std::max_element(all.depth.begin(), all.depth.begin() + static_cast<std::ptrdiff_t>(all.size())),
                  1e-9)
            << "step " << k;
        pose.position.z() -= 0.00005;
      }
      EXPECT_GT(force.spring.z(), 0.0);
    }
  }
}

}  // namespace
}  // namespace hapbench::every_algorithm_test
