#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/registry.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::proxy_test {
namespace {

/// Sums over the contacts i with the gradients u_i and the multipliers lambda_i (weights): `sum` is the sum of lambda_i
/// u_i, and `lambdas` the sum of lambda_i. The rounding error of `sum` is proportional to `lambdas`.
struct Held {
  Vec3 sum = Vec3::Zero();
  double lambdas = 0.0;
};
Held held(const ContactBuffer& contacts) {
  Held h;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    h.sum += contacts.weight[i] * contacts.gradient(i);
    h.lambdas += contacts.weight[i];
  }
  return h;
}

double violation(const ContactBuffer& contacts, std::size_t i, const Vec3& x) {
  return contacts.depth[i] + contacts.gradient(i).dot(x);
}

/// Random contacts and a wanted move [m]. The depths are chosen so that a random move, `allowed`, satisfies the
/// constraints of all contacts, and about 30 % of the constraints with equality.
struct Problem {
  ContactBuffer contacts;
  Vec3 wanted;
};
template <class Check>
void for_feasible_problems(Check check) {
  Random random(1);
  for (const test::GradientDistribution& family : test::gradient_distributions()) {
    for (int i = 0; i < 200; ++i) {
      const std::vector<Vec3> gradients = family.draw(random, test::random_size(random, 300));
      const Vec3 allowed = 1e-4 * random.uniform() * random.direction();
      std::vector<double> depths;
      for (const Vec3& u : gradients)
        depths.push_back(-u.dot(allowed) - (random.uniform() < 0.3 ? 0.0 : 1e-4 * random.uniform()));
      check(Problem{test::contacts_of(gradients, depths), 3e-4 * random.uniform() * random.direction()}, family.name);
    }
  }
}

// Checks the Karush-Kuhn-Tucker conditions. They characterise the solution, which is unique because the problem is
// strictly convex.
TEST(NearestAllowed, SatisfiesTheConditionsOfOptimality) {
  for_feasible_problems([](Problem problem, const char* family) {
    const AllowedMove allowed = nearest_allowed(problem.wanted, problem.contacts);
    ASSERT_TRUE(allowed.feasible) << family;
    // Lengths are up to 0.4 mm. The terms lambda_i u_i may nearly cancel; their rounding error then violates the
    // constraints of active contacts.
    const Held h = held(problem.contacts);
    const double rounding = 4e-4 * kViolationTolerance + 1e-13 * h.lambdas;
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      const double off = violation(problem.contacts, i, allowed.move);
      ASSERT_LE(off, rounding) << family;
      ASSERT_GE(problem.contacts.weight[i], 0.0) << family;
      ASSERT_TRUE(problem.contacts.weight[i] == 0.0 || off >= -rounding) << family;
    }
    // Up to three multipliers below the tolerance are omitted.
    ASSERT_LE((problem.wanted - h.sum - allowed.move).norm(), 4 * rounding) << family;
  });
}

TEST(NearestAllowed, HoldsTheSpanOfTheActiveContacts) {
  for_feasible_problems([](Problem problem, const char* family) {
    const Mat3 held = nearest_allowed(problem.wanted, problem.contacts).held;
    ASSERT_LE((held * held - held).norm(), 1e-14) << family;
    ASSERT_EQ(held, held.transpose()) << family;
    std::size_t active = 0;
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      if (problem.contacts.weight[i] == 0.0) continue;
      ++active;
      const Vec3 u = problem.contacts.gradient(i);
      ASSERT_LE((held * u - u).norm(), 1e-14) << family;
    }
    ASSERT_LE(active, 3u) << family;
    ASSERT_LE(held.trace(), static_cast<double>(active) + 1e-14) << family;
  });
}

/// Checks two opposite walls without room between them: n contacts with gradient x and depth a, m contacts with
/// gradient -x and depth b, a + b > 0.
TEST(NearestAllowed, SharesWhatOppositeWallsLackInEqualSquares) {
  for (const auto& [n, m] : {std::pair<std::size_t, std::size_t>{1, 1}, {3, 1}, {100, 250}}) {
    const double a = 3e-5, b = 1e-5;
    std::vector<Vec3> gradients(n, Vec3::UnitX());
    gradients.insert(gradients.end(), m, -Vec3::UnitX());
    std::vector<double> depths(n, a);
    depths.insert(depths.end(), m, b);
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const Vec3 wanted(2e-4, -1e-4, 5e-5);
    const AllowedMove allowed = nearest_allowed(wanted, contacts);
    EXPECT_FALSE(allowed.feasible);
    const double N = static_cast<double>(n), M = static_cast<double>(m);
    const double x = (M * b - N * a + kCompromiseEpsilon * wanted.x()) / (N + M + kCompromiseEpsilon);
    // The Newton step solves a linear system with the condition number (N + M) / epsilon.
    EXPECT_NEAR(allowed.move.x(), x, 1e-4 * 1e-16 * (N + M) / kCompromiseEpsilon);
    EXPECT_NEAR(allowed.move.y(), wanted.y(), 1e-12);
    EXPECT_NEAR(allowed.move.z(), wanted.z(), 1e-12);
    // The weight of each contact is its violation by the allowed move x. The gradients times the weights do not sum to
    // t - x, where t is the wanted move. `share` divides the remainder of t - x among all N + M contacts, so that the
    // sum below is t - x up to epsilon.
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_NEAR(contacts.weight[i], i < n ? a + x : b - x, 1e-10);
      sum += (contacts.weight[i] + allowed.share.dot(contacts.gradient(i))) * contacts.gradient(i);
    }
    EXPECT_LE((wanted - sum - allowed.move).norm(), 1e-9);
    EXPECT_NEAR(allowed.share.x(), (wanted.x() - x) / (N + M), 1e-9);
    EXPECT_NEAR(allowed.held(0, 0), 1.0, 1e-6);
    EXPECT_NEAR(allowed.held(1, 1), 0.0, 1e-9);
  }
}

TEST(NearestAllowed, FindsTheLeastSquaresOfContradictingContacts) {
  Random random(4);
  int contradicting = 0;
  for (int i = 0; i < 2'000; ++i) {
    const std::size_t n = 4 + random.below(60);
    std::vector<Vec3> gradients;
    std::vector<double> depths;
    for (std::size_t k = 0; k < n; ++k) {
      gradients.push_back(random.direction());
      depths.push_back(1e-4 * random.uniform(-0.5, 1.0));
    }
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const Vec3 wanted = 2e-4 * random.direction();
    const AllowedMove allowed = nearest_allowed(wanted, contacts);
    if (allowed.feasible) continue;
    ++contradicting;
    // At the minimum, the gradient of epsilon/2 |x - t|^2 + 1/2 sum max(0, violation)^2 vanishes, where x is the
    // allowed move and t the wanted move. The solver stops if the gradient is below epsilon times the tolerance. Sums
    // of n terms of 1e-4 add rounding errors.
    Vec3 gradient = kCompromiseEpsilon * (allowed.move - wanted);
    for (std::size_t k = 0; k < n; ++k) gradient += std::max(0.0, violation(contacts, k, allowed.move)) * gradients[k];
    ASSERT_LE(gradient.norm(), 1e-19 + 1e-20 * static_cast<double>(n * n));
    ASSERT_LE(lambda_max(allowed.held), 1.0);
  }
  EXPECT_GT(contradicting, 1'000);
}

/// Checks the stored energy 1/2 |x - t|^2 + 1/2 sum w^2 of a compromise, with the wanted move t, the allowed move x and
/// the weights w of the contacts. The multipliers must be the derivatives of this energy with respect to the depths,
/// and t - x its derivative with respect to t.
TEST(NearestAllowed, StoresInACompromiseWhatItsMultipliersTakeIn) {
  const std::vector<Vec3> gradients = {Vec3::UnitX(),  Vec3(0.6, 0.8, 0.0),  Vec3(0.6, -0.8, 0.0),
                                       -Vec3::UnitX(), Vec3(-0.8, 0.0, 0.6), Vec3(0.0, 0.6, -0.8)};
  const std::vector<double> depths = {3e-5, 2e-5, 1e-5, 4e-5, 2e-5, 5e-5};
  const Vec3 wanted(2e-4, -1e-4, 5e-5);
  const auto stored = [&](const Vec3& t, const std::vector<double>& d) {
    ContactBuffer contacts = test::contacts_of(gradients, d);
    const AllowedMove allowed = nearest_allowed(t, contacts);
    EXPECT_FALSE(allowed.feasible);
    double energy = 0.5 * (allowed.move - t).squaredNorm();
    for (std::size_t i = 0; i < contacts.size(); ++i) energy += 0.5 * contacts.weight[i] * contacts.weight[i];
    return energy;
  };
  ContactBuffer contacts = test::contacts_of(gradients, depths);
  const AllowedMove here = nearest_allowed(wanted, contacts);
  // Take central differences, which are exact while the same walls are violated, because the energy is then quadratic.
  // The multipliers equal the derivatives up to the order of epsilon = 1e-6.
  constexpr double h = 1e-8, kLengths = 3e-4;
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    std::vector<double> more = depths, less = depths;
    more[i] += h;
    less[i] -= h;
    const double lambda = contacts.weight[i] > 0.0 ? contacts.weight[i] + here.share.dot(gradients[i]) : 0.0;
    EXPECT_NEAR((stored(wanted, more) - stored(wanted, less)) / (2.0 * h), lambda, 1e-4 * kLengths) << i;
  }
  for (int k = 0; k < 3; ++k) {
    const Vec3 step = h * Vec3::Unit(k);
    EXPECT_NEAR((stored(wanted + step, depths) - stored(wanted - step, depths)) / (2.0 * h),
                (here.held * (wanted - here.move))[k], 1e-4 * kLengths);
    EXPECT_NEAR((here.held * (wanted - here.move))[k], (wanted - here.move)[k], 1e-4 * kLengths);
  }
}

TEST(NearestAllowed, EndsWithinItsIterationsOnNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -infinite}) {
    ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), -Vec3::UnitX(), Vec3(0, bad, 1)}, {1.0, bad, 1.0});
    for (const Vec3& wanted : {Vec3(bad, 0.0, 1.0), Vec3(0.0, 0.0, 1.0)})
      EXPECT_LE(nearest_allowed(wanted, contacts).iterations, 200)
          << bad;  // at most 100 iterations of the exact solver and 100 of the compromise
  }
}

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

/// A proxy and the points of a setting. step() moves the tool and updates `contacts`, `force` and `proxy_position`.
struct Rig {
  PointShell shell;
  ShellSource source;
  std::unique_ptr<ForceAlgorithm> proxy;
  ContactBuffer contacts;
  RenderedForce force;
  Vec3 proxy_position = Vec3::Zero();  ///< position of the proxy [m]

  Rig(const test::Setting& setting, const RenderingConfig& config)
      : shell(setting.points, 0.0),
        source(shell, setting.tool, make_contact_query(shell, setting.tool, Skips::off),
               make_depth_model("surface_normal")),
        proxy(make_algorithm(config)),
        contacts(source.capacity()) {
    proxy->prepare({source.capacity(), &setting.tool, &shell});
    proxy->reset();
  }
  void step(const ToolState& tool) {
    source.contacts_at(tool.pose, contacts);
    proxy->compute(tool, contacts, force);
    proxy_position = tool.pose.position + force.spring / kK;
  }
  /// Returns the depth of the deepest point in the tool at the position of the proxy [m].
  double deepest(const Vec3& axis) {
    ContactBuffer there(source.capacity());
    source.contacts_at({proxy_position, axis}, there);
    return there.largest_depth();
  }
};

/// Returns a tilted flat tool that is pressed into a plane of points. The lowest point of the tool, on the edge of its
/// tip, is `depth` below the plane z = 0. The position of the tool relative to the points of the plane is random.
test::Setting tilted_on_plane(double tilt, double depth, Random& random) {
  test::Setting setting;
  setting.points = surface_points(Plane{0.004, 0.0001});
  setting.tool = {0.0005, 0.01, Tip::flat};
  const Vec3 lean = random.direction_in_plane();
  setting.pose.axis = -std::cos(tilt) * Vec3::UnitZ() - std::sin(tilt) * lean;
  setting.pose.position = {1e-4 * random.uniform(), 1e-4 * random.uniform(), 0.0005 * std::sin(tilt) - depth};
  return setting;
}

/// Returns a pose 0.15 mm above the setting's pose. From there, the proxy reaches the plane in at most two passes.
ToolPose above(const test::Setting& setting) {
  return {setting.pose.position + Vec3(0, 0, 1.5e-4), setting.pose.axis};
}

TEST(ProxyRendering, OfAnEdgeOnAPlaneIsTheDepthOfTheEdgeWhereverThePointsLie) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    // The tilt is at least 0.11 rad, because the tip counts as flush with the plane at smaller tilts. The depth is
    // below 0.1 mm, because the first pass of the proxy finds only points within 0.1 mm of the proxy.
    const double tilt = random.uniform(0.11, 1.3), depth = 9e-5 * random.uniform();
    const test::Setting setting = tilted_on_plane(tilt, depth, random);
    test::Probe probe(setting, proxy_config());
    // The proxy must start outside of the shell, because otherwise the points would push it sideways out of the shell.
    probe.force_at(above(setting));
    const RenderedForce force = probe.force_at(setting.pose);
    EXPECT_LE((force.spring - Vec3(0, 0, kK * depth)).norm(), kK * 1e-12) << "tilt " << tilt << ", depth " << depth;
    EXPECT_LE((force.S - Mat3(Vec3(0, 0, 1).asDiagonal())).norm(), 1e-9);
  }
}

TEST(ProxyRendering, SlidesOverAFlatWithoutBumpingIntoThePointsAhead) {
  Random random(8);
  for (int run = 0; run < 10; ++run) {
    // The normals have errors of a few degrees, as from marching cubes.
    test::Setting setting;
    setting.points = surface_points(Plane{0.004, 0.0001});
    for (SurfacePoint& point : setting.points) point.normal = (point.normal + 0.1 * random.direction()).normalized();
    setting.tool = {0.0005, 0.01, Tip::flat};
    const Vec3 direction = random.direction_in_plane();
    test::Probe probe(setting, proxy_config());
    for (int step = 0; step <= 200; ++step) {
      const Vec3 p = 5e-6 * step * direction + Vec3(0, 0, step == 0 ? 1e-4 : -5e-5);
      const Vec3 force = probe.force_at({p, -Vec3::UnitZ()}).spring;
      // The flat patches of surface around the points are tilted by up to 0.1 rad and extend 0.75 spacings from their
      // points.
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
    // The tool moves and tilts in the slot, and is pulled through the walls and the floor.
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
      const double longest = (tool.pose.position - rig.proxy_position).norm() + 2e-4;
      ASSERT_LE(rig.deepest(tool.pose.axis), kViolationTolerance * longest) << "run " << run << ", step " << step;
    }
  }
  EXPECT_GT(held, 4'000);
}

TEST(ProxyRendering, HoldsAToolThatIsPulledThroughAPlane) {
  // The tool moves down until it is completely below the points. Penalty springs would then have no contact.
  test::Setting setting;
  setting.points = surface_points(Plane{0.004, 0.0001});
  setting.tool = {0.0005, 0.002, Tip::flat};
  test::Probe probe(setting, proxy_config());
  RenderedForce force;
  for (int step = 0; step < 500; ++step) force = probe.force_at({{0, 0, 1e-4 - 1e-5 * step}, -Vec3::UnitZ()});
  EXPECT_LE((force.spring - Vec3(0, 0, kK * 0.00489)).norm(), kK * 1e-12);
}

/// Half width of the tools [m].
constexpr double kHalfWidth = 0.0005;
/// Largest motion [m] in one step of a proxy that starts inside: 40 half widths per second.
const double kRecovery = 40.0 * kHalfWidth * Scene{}.dt;
/// Factor by which a move of the proxy may exceed kRecovery. The proxy shortens its move by reducing the depths of the
/// points inside it. The limit would be exact if the move were proportional to these depths. Points near the proxy, but
/// not inside it, make the proportion approximate.
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
    const Vec3 moved = rig.proxy_position - last;
    ASSERT_GE(moved.z(), -1e-15) << step;
    ASSERT_LE(moved.norm(), kNearly * kRecovery) << step;
    last = rig.proxy_position;
  }
  EXPECT_LE((rig.force.spring - Vec3(0, 0, kK * depth)).norm(), kK * 1e-9);
  // Check that the proxy stays outside once it is outside, however fast the tool rotates.
  const ToolPose turned{tool.pose.position, Vec3(1.0, 0.0, 0.02).normalized()};
  rig.step({turned, Vec3::Zero()});
  EXPECT_LE(rig.deepest(turned.axis), 1e-10);
  EXPECT_GT((rig.proxy_position - last).norm(), kRecovery);
}

TEST(ProxyRendering, StoresTheEnergyOfOneSpring) {
  Random random(5);
  const test::Setting setting = tilted_on_plane(0.5, 5e-5, random);
  Rig rig(setting, proxy_config());
  rig.step({above(setting), Vec3::Zero()});
  rig.step({setting.pose, Vec3::Zero()});
  const SpringState state = rig.proxy->spring_state({setting.pose, Vec3::Zero()}, rig.contacts);
  EXPECT_NEAR(state.energy, 0.5 * kK * 5e-5 * 5e-5, 1e-15);
  EXPECT_EQ(rig.proxy->jacobian().stiffness, Mat3(kK * rig.force.S));
}

TEST(ProxyRendering, DampsTheTurnOfTheEdgeThatTouches) {
  Random random(7);
  const test::Setting setting = tilted_on_plane(0.6, 5e-5, random);
  RenderingConfig config = proxy_config();
  config.angular_damping = true;
  Rig rig(setting, config);
  EXPECT_TRUE(rig.proxy->angular_velocity_cutoff());
  rig.step({above(setting), Vec3::Zero()});
  const Vec3 turn(0.3, -0.4, 0.1);
  rig.step({setting.pose, Vec3::Zero(), turn});
  ASSERT_EQ(rig.contacts.size(), 1u);
  // One flat patch around a point of the plane holds the edge. The velocity omega x r of the proxy at this point is
  // damped along the normal of the plane.
  const double along = turn.cross(rig.contacts.point(0) - rig.proxy_position).z();
  const double B = 2.0 * config.damping_ratio * std::sqrt(kK * config.mass);
  EXPECT_LE((rig.force.rendered - rig.force.spring - Vec3(0, 0, -B * along)).norm(), 1e-12);
}

/// Checks two planes. The tool touches the second plane later than the first plane. In each step, the damping along the
/// normal of the second plane increases by a fraction of the missing damping, even if an integrator evaluates several
/// forces in the step.
TEST(ProxyRendering, DampsANewDirectionWithItsTimeConstant) {
  const SpringSet planes{{Vec3::UnitX(), Vec3::UnitZ()}, false};
  RenderingConfig config = proxy_config();
  config.parameters["proxy"]["damping_time_s"] = 0.003;
  config.mu_s = config.mu_f = 0.0;
  const auto proxy = make_algorithm(config);
  std::uint64_t row = 0;
  Scene scene;
  scene.capacity = 4;
  scene.springs = &planes;
  scene.dt = 0.001;
  scene.row = &row;
  proxy->prepare(scene);
  proxy->reset();
  const Vec3 v(0.1, 0.2, 0.3);
  const double B = 2.0 * config.damping_ratio * std::sqrt(kK * config.mass);
  ContactBuffer contacts(4);
  RenderedForce force;
  const auto damped = [&](const Vec3& position) {
    proxy->compute({{position, -Vec3::UnitZ()}, v}, contacts, force);
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
  EXPECT_LE((proxy->jacobian().damping - Mat3(Vec3(B, 0, B * second).asDiagonal())).norm(), 1e-12 * B);
  row = 3;
  EXPECT_EQ(damped({-1e-4, 0, -1e-4}), Vec3(Vec3::Zero())) << "gone with the last contact";
  proxy->reset();
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

}  // namespace
}  // namespace hapbench::proxy_test
