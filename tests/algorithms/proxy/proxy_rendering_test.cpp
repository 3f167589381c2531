#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/proxy/proxy_rendering.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/contact/stiffness_tensor.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::proxy_rendering_test {
namespace {

TEST(SpringConstraints, OfABilateralSpringHoldTheToolFromBothSides) {
  const SpringSet springs{{{1, 0, 0}, {0, 0, 1}}, true};
  SpringConstraints constraints(springs);
  ContactBuffer contacts(constraints.capacity());
  ASSERT_EQ(constraints.capacity(), 4u);
  constraints.constraints_at({{0.25, 0.0, -0.5}}, Vec3::Zero(), contacts);
  ASSERT_EQ(contacts.size(), 4u);
  const double depths[] = {0.25, -0.25, -0.5, 0.5};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(contacts.index[i], i / 2);
    EXPECT_EQ(contacts.depth[i], depths[i]);
    EXPECT_EQ(contacts.gradient(i), Vec3((i % 2 == 0 ? 1.0 : -1.0) * springs.gradients[i / 2]));
  }
  EXPECT_EQ(constraints.work().points_tested, 2u);
}

TEST(ShellConstraints, AreThoseOfEveryPointWithinTheMargin) {
  const Cylinder tool;
  const PointShell shell(surface_points(Plane{0.004, 0.0001}), 0.0);
  for (const Skips skips : {Skips::on, Skips::off}) {
    ShellConstraints constraints(shell, tool, skips);
    EXPECT_EQ(constraints.margin(), kProxyMargin * tool.radius());
    ContactBuffer contacts(constraints.capacity());
    // The tip plane is half a margin above the plane of the points.
    const double height = 0.5 * constraints.margin();
    constraints.constraints_at({{0.0, 0.0, height}}, -Vec3::UnitZ(), contacts);
    std::vector<bool> found(shell.size(), false);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      found[contacts.index[i]] = true;
      EXPECT_LE(contacts.depth[i], -height + 1e-18);
    }
    std::size_t below = 0;
    for (std::size_t i = 0; i < shell.size(); ++i) {
      if (shell.point(i).position.norm() > tool.radius()) continue;
      EXPECT_TRUE(found[i]);
      ++below;
    }
    EXPECT_GT(below, 50u);
    constraints.constraints_at({{0.0, 0.0, 0.001}}, -Vec3::UnitZ(), contacts);
    EXPECT_TRUE(contacts.empty());
  }
}

constexpr double kK = 20'000.0;

RenderingConfig proxy_config() {
  RenderingConfig config;
  config.algorithm = "proxy";
  config.stiffness = kK;
  return config;
}

/// A proxy in a setting, stepped by hand.
struct Rig {
  PointShell shell;
  ShellSource source;
  ProxyRendering proxy;
  ContactBuffer contacts;
  RenderedForce force;

  Rig(const test::Setting& setting, const RenderingConfig& config)
      : shell(setting.points, 0.0),
        source(shell, setting.tool, std::make_unique<ShellQuery>(shell, setting.tool),
               make_depth_model("surface_normal")),
        proxy(config),
        contacts(source.capacity()) {
    proxy.prepare({source.capacity(), &setting.tool, &shell});
    proxy.reset();
  }
  void step(const ToolState& tool) {
    source.contacts_at(tool.pose, contacts);
    proxy.compute(tool, contacts, force);
  }
  /// How deep a point is in the tool at the proxy's place [m].
  double deepest(const Vec3& axis) {
    ContactBuffer there(source.capacity());
    source.contacts_at({proxy.proxy(), axis}, there);
    return there.largest_depth();
  }
};

/// A tilted flat tool whose lowest place, on the edge of its tip, is `depth` below the plane z = 0, anywhere between
/// the points of the plane.
test::Setting tilted_on_plane(double tilt, double depth, Random& random) {
  test::Setting setting;
  setting.points = surface_points(Plane{0.004, 0.0001});
  setting.tool = {0.0005, 0.01, Tip::flat};
  const Vec3 lean = random.direction_in_plane();
  setting.pose.axis = -std::cos(tilt) * Vec3::UnitZ() - std::sin(tilt) * lean;
  setting.pose.position = {1e-4 * random.uniform(), 1e-4 * random.uniform(), 0.0005 * std::sin(tilt) - depth};
  return setting;
}

/// A pose clear of the plane, at most two passes away.
ToolPose above(const test::Setting& setting) {
  return {setting.pose.position + Vec3(0, 0, 1.5e-4), setting.pose.axis};
}

TEST(ProxyRendering, OfAnEdgeOnAPlaneIsTheDepthOfTheEdgeWhereverThePointsLie) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    // Below 0.11 rad the tip is flush with the plane; the first pass looks 0.1 mm ahead.
    const double tilt = random.uniform(0.11, 1.3), depth = 9e-5 * random.uniform();
    const test::Setting setting = tilted_on_plane(tilt, depth, random);
    test::Probe probe(setting, proxy_config());
    // The proxy must come from outside, because points would push it sideways out of the shell.
    probe.force_at(above(setting));
    const RenderedForce force = probe.force_at(setting.pose);
    EXPECT_LE((force.spring - Vec3(0, 0, kK * depth)).norm(), kK * 1e-12) << "tilt " << tilt << ", depth " << depth;
    EXPECT_LE((force.S - Mat3(Vec3(0, 0, 1).asDiagonal())).norm(), 1e-9);
  }
}

TEST(ProxyRendering, SlidesOverAFlatWithoutBumpingIntoThePointsAhead) {
  Random random(8);
  for (int run = 0; run < 10; ++run) {
    // Normals with errors of a few degrees, as from marching cubes.
    test::Setting setting;
    setting.points = surface_points(Plane{0.004, 0.0001});
    for (SurfacePoint& point : setting.points) point.normal = (point.normal + 0.1 * random.direction()).normalized();
    setting.tool = {0.0005, 0.01, Tip::flat};
    const Vec3 way = random.direction_in_plane();
    test::Probe probe(setting, proxy_config());
    for (int step = 0; step <= 200; ++step) {
      const Vec3 p = 5e-6 * step * way + Vec3(0, 0, step == 0 ? 1e-4 : -5e-5);
      const Vec3 force = probe.force_at({p, -Vec3::UnitZ()}).spring;
      // The planes of the patches are tilted by up to 0.1 rad and reach 0.75 spacings from their points.
      if (step > 0) {
        EXPECT_LE((force - Vec3(0, 0, kK * 5e-5)).norm(), 0.2 * kK * 5e-5) << "step " << step;
      }
    }
  }
}

TEST(ProxyRendering, NeverLetsThePointsInWhereTheToolHasRoom) {
  Random random(3);
  int held = 0;
  for (int run = 0; run < 20; ++run) {
    test::Setting setting;
    setting.tool = {0.0005, 0.01, run % 2 == 0 ? Tip::flat : Tip::round};
    setting.points = surface_points(Slot{0.0016, 0.002, 0.004, 0.0001});
    const std::vector<SurfacePoint> floor = surface_points(Plane{0.004, 0.0001});
    for (SurfacePoint point : floor) {
      point.position.z() -= 0.002;
      setting.points.push_back(point);
    }
    Rig rig(setting, proxy_config());
    // A tool swept about and tilted in the slot, pulled through its walls and its floor.
    Vec3 velocity = Vec3::Zero();
    ToolState tool{{{0, 0, 0.001}, -Vec3::UnitZ()}, Vec3::Zero()};
    for (int step = 0; step < 400; ++step) {
      velocity = 0.95 * velocity + 3e-5 * random.direction() - 0.003 * (tool.pose.position + Vec3(0, 0, 0.002));
      tool.pose.position += velocity;
      tool.pose.axis =
          (tool.pose.axis + 0.004 * random.direction() - 0.02 * (tool.pose.axis + Vec3::UnitZ())).normalized();
      rig.step(tool);
      held += !rig.contacts.empty();
      ASSERT_LE(lambda_max(rig.force.S), 1.0 + 1e-12);
      const double longest = (tool.pose.position - rig.proxy.proxy()).norm() + 2e-4;
      ASSERT_LE(rig.deepest(tool.pose.axis), kViolationTolerance * longest) << "run " << run << ", step " << step;
    }
  }
  EXPECT_GT(held, 4'000);
}

TEST(ProxyRendering, HoldsAToolThatIsPulledThroughAPlane) {
  // The whole tool is below the points, where penalty springs have no contact.
  test::Setting setting;
  setting.points = surface_points(Plane{0.004, 0.0001});
  setting.tool = {0.0005, 0.002, Tip::flat};
  test::Probe probe(setting, proxy_config());
  RenderedForce force;
  for (int step = 0; step < 500; ++step) force = probe.force_at({{0, 0, 1e-4 - 1e-5 * step}, -Vec3::UnitZ()});
  EXPECT_LE((force.spring - Vec3(0, 0, kK * 0.00489)).norm(), kK * 1e-12);
}

/// Half width of the tools.
constexpr double kHalfWidth = 0.0005;
/// Motion of a proxy that starts inside in one step.
const double kRecovery = kRecoverySpeed * kHalfWidth * Scene{}.dt;
/// A move is only nearly proportional to the depths, because points that are not yet entered stay in place.
constexpr double kNearly = 1.1;

TEST(ProxyRendering, LeavesAPlaneItStartsInSlowlyAndThenForGood) {
  test::Setting setting;
  setting.points = surface_points(Plane{0.02, 0.0001});
  setting.tool = {0.0005, 0.004, Tip::flat};
  const double depth = 2e-4;
  const ToolState tool{{{0.0, 0.0, kHalfWidth - depth}, Vec3::UnitX()}, Vec3::Zero()};
  Rig rig(setting, proxy_config());
  Vec3 last = tool.pose.position;
  for (int step = 0; step < 40; ++step) {
    rig.step(tool);
    const Vec3 moved = rig.proxy.proxy() - last;
    ASSERT_GE(moved.z(), -1e-15) << step;
    ASSERT_LE(moved.norm(), kNearly * kRecovery) << step;
    last = rig.proxy.proxy();
  }
  EXPECT_LE((rig.force.spring - Vec3(0, 0, kK * depth)).norm(), kK * 1e-9);
  // Once outside, it stays outside, however fast the tool turns.
  const ToolPose turned{tool.pose.position, Vec3(1.0, 0.0, 0.02).normalized()};
  rig.step({turned, Vec3::Zero()});
  EXPECT_LE(rig.deepest(turned.axis), 1e-10);
  EXPECT_GT((rig.proxy.proxy() - last).norm(), kRecovery);
}

TEST(ProxyRendering, StoresTheEnergyOfOneSpring) {
  Random random(5);
  const test::Setting setting = tilted_on_plane(0.5, 5e-5, random);
  Rig rig(setting, proxy_config());
  rig.step({above(setting), Vec3::Zero()});
  rig.step({setting.pose, Vec3::Zero()});
  const SpringState state = rig.proxy.spring_state({setting.pose, Vec3::Zero()}, rig.contacts);
  EXPECT_NEAR(state.energy, 0.5 * kK * 5e-5 * 5e-5, 1e-15);
  EXPECT_EQ(rig.proxy.jacobian().stiffness, Mat3(kK * rig.force.S));
}

TEST(ProxyRendering, DampsTheTurnOfTheEdgeThatTouches) {
  Random random(7);
  const test::Setting setting = tilted_on_plane(0.6, 5e-5, random);
  RenderingConfig config = proxy_config();
  config.angular_damping = true;
  Rig rig(setting, config);
  EXPECT_TRUE(rig.proxy.angular_velocity_cutoff());
  rig.step({above(setting), Vec3::Zero()});
  const Vec3 turn(0.3, -0.4, 0.1);
  rig.step({setting.pose, Vec3::Zero(), turn});
  ASSERT_EQ(rig.contacts.size(), 1u);
  // One patch holds the edge. The normal component of the velocity omega x r of its point is damped.
  const double along = turn.cross(rig.contacts.point(0) - rig.proxy.proxy()).z();
  const double B = 2.0 * config.damping_ratio * std::sqrt(kK * config.mass);
  EXPECT_LE((rig.force.rendered - rig.force.spring - Vec3(0, 0, -B * along)).norm(), 1e-12);
}

/// Two planes, of which the tool touches the second one later. Its direction is damped by a share of what is missing in
/// each row, however often an integrator asks within the row.
TEST(ProxyRendering, DampsANewDirectionWithItsTimeConstant) {
  const SpringSet planes{{Vec3::UnitX(), Vec3::UnitZ()}, false};
  RenderingConfig config = proxy_config();
  config.parameters["proxy"]["damping_time_s"] = 0.003;
  config.mu_s = config.mu_f = 0.0;
  ProxyRendering proxy(config);
  std::uint64_t row = 0;
  Scene scene;
  scene.capacity = 4;
  scene.springs = &planes;
  scene.dt = 0.001;
  scene.row = &row;
  proxy.prepare(scene);
  proxy.reset();
  const Vec3 v(0.1, 0.2, 0.3);
  const double B = 2.0 * config.damping_ratio * std::sqrt(kK * config.mass);
  ContactBuffer contacts(4);
  RenderedForce force;
  const auto damped = [&](const Vec3& position) {
    proxy.compute({{position, -Vec3::UnitZ()}, v}, contacts, force);
    return Vec3((force.spring - force.rendered) / B);
  };
  const double share = 0.001 / 0.004;
  EXPECT_LE((damped({1e-4, 0, -1e-4}) - Vec3(0.1, 0, 0)).norm(), 1e-15) << "a first contact at once";
  row = 1;
  for (int ask = 0; ask < 3; ++ask) {
    EXPECT_LE((damped({1e-4, 0, 1e-4}) - Vec3(0.1, 0, share * 0.3)).norm(), 1e-15) << ask;
    EXPECT_EQ(force.S, Mat3(Vec3(1, 0, 1).asDiagonal())) << "what is reported is stiffness";
  }
  row = 2;
  const double second = share + share * (1.0 - share);
  EXPECT_LE((damped({1e-4, 0, 1e-4}) - Vec3(0.1, 0, second * 0.3)).norm(), 1e-15);
  EXPECT_LE((proxy.jacobian().damping - Mat3(Vec3(B, 0, B * second).asDiagonal())).norm(), 1e-12 * B);
  row = 3;
  EXPECT_EQ(damped({-1e-4, 0, -1e-4}), Vec3(Vec3::Zero())) << "gone with the last contact";
  proxy.reset();
  row = 0;
  EXPECT_LE((damped({-1e-4, 0, 1e-4}) - Vec3(0, 0, 0.3)).norm(), 1e-15) << "nothing is left after a reset";
}

TEST(ProxyRendering, AnswersAPoseThatIsNotFiniteWithAForceThatIsNotUntilAReset) {
  Random random(6);
  const test::Setting setting = tilted_on_plane(0.5, 5e-5, random);
  test::Probe probe(setting, proxy_config());
  const Vec3 force = probe.force_at(setting.pose).spring;
  const ToolPose nowhere{Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), setting.pose.axis};
  EXPECT_FALSE(probe.force_at(nowhere).spring.allFinite());
  probe.algorithm().reset();
  EXPECT_EQ(probe.force_at(setting.pose).spring, force);
}

TEST(TypicalSpacing, IsThatOfALatticeAndOfALine) {
  EXPECT_NEAR(typical_spacing(PointShell(surface_points(Plane{0.004, 0.0001}), 0.0)), 1e-4, 1e-12);
  EXPECT_NEAR(typical_spacing(PointShell(surface_points(Hole2d{}), 0.0)), 1e-4, 1e-12);
  EXPECT_EQ(typical_spacing(PointShell({}, 0.0)), 0.0);
  // Each point four times, with rounding.
  std::vector<SurfacePoint> copies;
  for (const SurfacePoint& point : surface_points(Plane{0.004, 0.0001})) {
    for (int k = 0; k < 4; ++k) {
      copies.push_back(point);
      copies.back().position.z() += 1e-16 * k;
    }
  }
  EXPECT_NEAR(typical_spacing(PointShell(copies, 0.0)), 1e-4, 1e-12);
}

}  // namespace
}  // namespace hapbench::proxy_rendering_test
