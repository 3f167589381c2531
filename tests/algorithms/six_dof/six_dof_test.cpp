#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "algorithms/proxy/turning_proxy.hpp"
#include "algorithms/registry.hpp"
#include "algorithms/six_dof/devices.hpp"
#include "algorithms/six_dof/turns.hpp"
#include "results/summary/allocations.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/mesh/marching_cubes.hpp"
#include "sim/tool/cylinder.hpp"

// Tests predictions about the force of a 6-DOF device, which is the reference for the force of a 3-DOF device. Each
// prediction has a closed form. Symbols as in algorithms/six_dof: F is the force of the 6-DOF device and f the force of
// the 3-DOF device. K_t and K_r are the translational and rotational stiffness of the coupling, and K_h and K_phi are
// the translational and rotational stiffness of the hand. K' and K_r' are the translational and rotational stiffness of
// coupling and hand in series. c is the distance from the force point to the grip, l the distance from the force point
// to the contact, both positive towards the tip.
namespace hapbench::six_dof {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
/// Rotational stiffness of a nearly rigid coupling [N m/rad]. With a hand of 0.2 N m/rad, K_r' equals K_phi to 2e-5.
constexpr double kRigid = 1e4;
constexpr double kRadius = 0.0005, kLength = 0.01;

RenderingConfig law(const char* name, double stiffness) {
  RenderingConfig config;
  config.algorithm = name;
  config.stiffness = stiffness;
  return config;
}
RenderingConfig proxy(double stiffness, double rotation) {
  RenderingConfig config = law("proxy", stiffness);
  config.parameters["proxy"][kRotationalStiffness] = rotation;
  return config;
}

/// Returns the pose that a hand intends for a drill. The drill is tilted from upright by `tilt` [rad] about +y, so that
/// a positive tilt moves the tip towards -x. The position `tip` [m] is the position of the point on the drill's axis
/// that lies `pivot` [m] behind the tip.
Intent intent_of(const HandAndCoupling& springs, const Vec3& tip, double tilt, double pivot = 0.0) {
  Intent intent;
  intent.orientation = turn_by({0.0, tilt, 0.0});
  const Vec3 axis = intent.orientation * Vec3(0.0, 0.0, -1.0);
  intent.grip = tip + (pivot - springs.force_point + springs.grip) * axis;
  return intent;
}

/// A contact that touches the side of an upright drill from -x, at the distance `lever` from the force point towards
/// the tip. The 6-DOF and the 3-DOF device press against the contact by the same displacement (pressed()). The contact
/// consists of two points at +-45 degrees. On a single point, the drill of the 6-DOF device would slide off sideways
/// when the force exceeds K' r = 0.2 N.
struct OneContact {
  explicit OneContact(const HandAndCoupling& s, double lever)
      : springs(s), tool(kRadius, kLength, Tip::flat), shell(notch(s.force_point - lever), 0.0) {}
  static std::vector<SurfacePoint> notch(double height) {
    const double s = std::numbers::sqrt2 / 2;
    return {{{-kRadius * s, -kRadius * s, height}, {s, s, 0.0}}, {{-kRadius * s, kRadius * s, height}, {s, -s, 0.0}}};
  }

  /// Presses in two hundred steps and returns the force on the handle [N]. The displacement is so small that rotations
  /// stay below 1e-4 rad, and the linear closed forms are accurate to this fraction.
  template <class Device>
  Vec3 pressed(Device& device) const {
    for (int k = -10; k <= 190; ++k) device.follow(intent_of(springs, {-1e-6 / 190 * k, 0.0, 0.0}, 0.0));
    return device.handle().force;
  }
  double reference() const {
    SixDofDevice device(shell, tool, springs, Skips::on);
    return pressed(device).x();
  }
  double with(const RenderingConfig& config) const {
    ThreeDofDevice device(shell, tool, springs, config, 0.0005);
    return pressed(device).x();
  }
  /// Closed forms of the compliance [m/N]: compliance() of the 6-DOF device, and compliance_of_proxy(k) of a proxy with
  /// the rotational stiffness k [N m/rad].
  double compliance() const {
    const double l = lever(), c = springs.grip;
    return 1.0 / series() + (l - c) * (l - c) / springs.hand_rotation + l * l / springs.coupling_rotation;
  }
  double compliance_of_proxy(double k) const {
    const double l = lever(), c = springs.grip;
    return 1.0 / series() - c * (l - c) / springs.hand_rotation + l * l / k;
  }
  double lever() const { return springs.force_point - shell.point(0).position.z(); }
  double series() const { return springs.coupling * springs.hand / (springs.coupling + springs.hand); }

  HandAndCoupling springs;
  Cylinder tool;
  PointShell shell;
};

constexpr HandAndCoupling kSprings = {.coupling = 2000.0,
                                      .coupling_rotation = 0.4,
                                      .hand = 500.0,
                                      .hand_rotation = 0.2,
                                      .force_point = 0.035,
                                      .grip = 0.0};
/// Largest relative error of the closed forms. They neglect that a rotation of up to 1e-4 rad changes the normal and
/// the lever of the contact.
constexpr double kLinear = 1e-4;

HandAndCoupling with(HandAndCoupling springs, const std::function<void(HandAndCoupling&)>& change) {
  change(springs);
  return springs;
}

// ---- Rotations and energies

TEST(Turns, AreTheInverseOfEachOtherAndHaveTheirDerivative) {
  const Vec3 v(0.3, -0.9, 0.5), w = 1e-6 * Vec3(0.2, 0.7, -0.4);
  const Eigen::Quaterniond from = turn_by({1.0, 0.2, -0.3});
  EXPECT_LE((turn_between(from, turned(from, v)) - v).norm(), 1e-14);
  // The error of the linear approximation is of second order in w: |w|^2 = 1e-12.
  EXPECT_LE(
      (turn_between(Eigen::Quaterniond::Identity(), turned(turn_by(v), w)) - v - rotation_vector_derivative(v) * w)
          .norm(),
      1e-12);
  // rotation_vector_derivative() uses one formula below the angle 0.01 and another formula above it. Both formulas
  // agree at this angle.
  const Vec3 small = 0.0099999 * v.normalized(), larger = 0.0100001 * v.normalized();
  EXPECT_LE((rotation_vector_derivative(small) - rotation_vector_derivative(larger)).norm(), 3e-7);
}

TEST(PoseSprings, HaveTheDerivativesOfTheirEnergy) {
  const PoseSprings springs = {.stiffness = 400.0,
                               .coupling_rotation = 0.4,
                               .hand_rotation = 0.2,
                               .grip = 0.012,
                               .grip_target = {0.001, 0.002, -0.01},
                               .target = turn_by({0.1, 0.3, 0.0})};
  // Returns the smallest energy over all rotations of the handle. Newton steps with energy_model() find this rotation.
  const auto energy_at = [&](CoupledPose pose) {
    for (int i = 0; i < 50; ++i) move(pose, energy_model(springs, pose), Vec6::Zero());
    return 0.5 * spring_force(springs, pose).squaredNorm() / springs.stiffness +
           0.5 * spring_torque(springs, pose).squaredNorm() / springs.coupling_rotation +
           0.5 * springs.hand_rotation * turn_between(springs.target, pose.handle).squaredNorm();
  };
  CoupledPose pose{{0.004, -0.001, 0.003}, turn_by({0.4, 0.1, 0.2}), springs.target};
  for (int i = 0; i < 50; ++i) move(pose, energy_model(springs, pose), Vec6::Zero());
  const EnergyModel model = energy_model(springs, pose);
  EXPECT_LE(model.handle_gradient.norm(), 1e-14);
  EnergyModel still = model;  // model in which only the tool moves
  still.handle_turn.setZero();
  still.handle_follows.setZero();
  for (int k = 0; k < 6; ++k) {
    // Compare gradient and Hessian with central differences of the energy with a step h. The energy is about 1e-2 J.
    // The rounding error of the first difference is 1e-18 / h, and its truncation error is of order h^2.
    const double h = k < 3 ? 1e-6 : 1e-4;
    const auto at = [&](double sign) {
      CoupledPose moved = pose;
      Vec6 z = Vec6::Zero();
      z[k] = sign * h;
      move(moved, still, z);
      return energy_at(moved);
    };
    EXPECT_NEAR((at(1) - at(-1)) / (2 * h), model.gradient[k], 1e-8 + 1e-7 * std::abs(model.gradient[k])) << k;
    EXPECT_NEAR((at(1) - 2 * energy_at(pose) + at(-1)) / (h * h), model.hessian(k, k), 1e-4 * model.hessian(k, k)) << k;
  }
}

// ---- Prediction 1: with one contact at the lever l and the grip at the force point, f / F = 1 + K' l^2 / K_r'

TEST(OneContact, IsTooStiffUnderAProxyThatDoesNotTurn) {
  for (const double rotation : {kRigid, 0.4}) {
    const OneContact contact(with(kSprings, [&](auto& s) { s.coupling_rotation = rotation; }), 0.03);
    const double ratio = 1.0 + contact.series() * 9e-4 / contact.springs.matched_rotation();
    EXPECT_NEAR(ratio, rotation == kRigid ? 2.8 : 3.7, 1e-4);
    EXPECT_NEAR(contact.with(law("proxy", 2000.0)) / contact.reference(), ratio, kLinear * ratio);
  }
}

TEST(OneContact, IsRightUnderAProxyThatDoesNotTurnIfTheForceActsThere) {
  const OneContact contact(with(kSprings,
                                [](auto& s) {
                                  s.force_point = 0.005;
                                  s.grip = -0.03;
                                }),
                           0.0);
  EXPECT_NEAR(contact.with(law("proxy", 2000.0)) / contact.reference(), 1.0, kLinear);
}

// ---- Prediction 2: the rotational stiffness at which the proxy renders F, and the error of the proxy with K_r'

TEST(OneContact, HasTheForcesOfTheClosedForms) {
  for (const auto& [l, c, error] : {std::array{0.03, 0.01, -0.18}, {0.03, -0.01, 0.13}, {0.04, 0.02, -0.32}}) {
    const OneContact contact(with(kSprings,
                                  [l = l, c = c](auto& s) {
                                    s.force_point = l + 0.005;
                                    s.grip = c;
                                  }),
                             l);
    const double reference = contact.reference(), series = contact.springs.matched_rotation();
    EXPECT_NEAR(reference * contact.compliance(), 1e-6, kLinear * 1e-6);
    const double ratio = contact.with(proxy(2000.0, series)) / reference;
    EXPECT_NEAR(ratio, contact.compliance() / contact.compliance_of_proxy(series), kLinear);
    EXPECT_NEAR(ratio, 1.0 + error, 0.005) << "as published, in per cent";
    const double matched =
        1.0 / (1.0 / contact.springs.coupling_rotation + (1.0 - c / l) / contact.springs.hand_rotation);
    EXPECT_NEAR(contact.with(proxy(2000.0, matched)) / reference, 1.0, kLinear);
  }
}

// If 1/K' < c (l - c) / K_phi, the force rotates the tip into the wall, and there is no equilibrium near the upright
// pose. Tests one value of c for which the inequality holds and one for which it does not.
TEST(OneContact, HasNoEquilibriumWhereTheForceTurnsTheTipIntoTheWall) {
  for (const auto& [c, stable] : {std::pair{0.015, false}, {0.008, true}}) {
    const OneContact contact(with(kSprings,
                                  [c = c](auto& s) {
                                    s.force_point = 0.065;
                                    s.grip = c;
                                  }),
                             0.06);
    EXPECT_EQ(contact.compliance_of_proxy(kInfinite) > 0.0, stable);
    ThreeDofDevice device(contact.shell, contact.tool, contact.springs, law("proxy", 2000.0), 0.0005);
    double rest = 0.0;
    for (int k = -1; k <= 20; ++k) rest = device.follow(intent_of(contact.springs, {-1e-5 * k, 0.0, 0.0}, 0.0));
    const double force = device.handle().force.x();
    const double expected = 2e-4 / contact.compliance_of_proxy(kInfinite);
    // The drill rotates by 0.02 rad. The compliance is a difference of terms, which amplifies the errors of the closed
    // form about ten times.
    if (stable)
      EXPECT_NEAR(force, expected, 0.05 * expected);
    else
      // The force of the closed form is negative, and a wall cannot pull. Therefore the device must find no balanced
      // pose, or a balanced pose far from the upright pose.
      EXPECT_TRUE(rest > kBalanced || force > 0.5) << "far away, or nowhere";
  }
}

// The following test checks that the proxy with the rotational stiffness K_r' renders the force of the 6-DOF device if
// the grip is at the force point.

struct Path {
  std::vector<SurfacePoint> points;
  std::function<Intent(const HandAndCoupling&, double)> intent;  ///< pose that the hand intends at t = 0 … 1
};
std::vector<SurfacePoint> groove() {
  std::vector<SurfacePoint> points;
  const double s = std::numbers::sqrt2 / 2;
  for (const double side : {-1.0, 1.0})
    for (int i = 0; i <= 20; ++i)
      for (int j = -30; j <= 30; ++j)
        points.push_back({{side * 1e-4 * i * s, 1e-4 * j, 1e-4 * i * s}, {-side * s, 0, s}});
  return points;
}

class GripAtTheForcePoint : public testing::TestWithParam<int> {
 protected:
  static Path path() {
    switch (GetParam()) {
      case 0:  // a drill lies in a groove, is pressed down and turned across it and down
        return {groove(), [](const HandAndCoupling& s, double t) {
                  Intent intent;
                  intent.orientation = turn_by({0.05 * t, 0.0, 0.03 * t}) * turn_by({std::numbers::pi / 2, 0.0, 0.0});
                  const Vec3 axis = intent.orientation * Vec3(0.0, 0.0, -1.0);
                  intent.grip = Vec3(1e-5 * t, 0.002, 7.5e-4 - 1e-3 * t) + (s.grip - s.force_point) * axis;
                  return intent;
                }};
      case 1: {  // task 2: a drill in a hole, near 504 of its points
        BlockWithHole block;
        block.size = {0.004, 0.004, 0.006};
        const IsoSurface surface = marching_cubes(density_field(block, 1e-4, Density::signed_distance));
        return {surface.vertices, [](const HandAndCoupling& s, double t) {
                  return intent_of(s, {-0.0003, 0.0, -0.002 - 0.001 * t}, 0.34 + 0.15 * t);
                }};
      }
      default:  // a drill beside the edge of a plane leans on it
        return {surface_points(Plane{.size = 0.004}), [](const HandAndCoupling& s, double t) {
                  return intent_of(s, {0.0026 - 0.0006 * t, 5e-5, -0.004}, -0.1 * t);
                }};
    }
  }
};

TEST_P(GripAtTheForcePoint, TheMatchedProxyRendersTheForceOfTheSixDofDevice) {
  const Path path = GripAtTheForcePoint::path();
  const PointShell shell(path.points, 0.0);
  const Cylinder tool(kRadius, kLength, Tip::flat);
  for (const double force_point : {0.0, 0.03}) {
    const HandAndCoupling springs = with(kSprings, [&](auto& s) {
      s.coupling = 20000.0;
      s.force_point = force_point;
    });
    SixDofDevice reference(shell, tool, springs, Skips::on);
    ThreeDofDevice matched(shell, tool, springs, proxy(20000.0, springs.matched_rotation()), 0.0005);
    ThreeDofDevice stiff(shell, tool, springs, law("proxy", 20000.0), 0.0005);
    double force = 0.0, turn = 0.0;
    for (int k = 0; k <= 100; ++k) {
      const Intent intent = path.intent(springs, 0.01 * k);
      const auto step = reference.follow(intent);
      ASSERT_TRUE(step.solved) << k;
      ASSERT_LE(step.residual, kSolved);
      ASSERT_LE(matched.follow(intent), 1e-9) << k;
      ASSERT_LE((matched.handle().force - reference.handle().force).norm(), 1e-6) << k << ' ' << step.jumped;
      stiff.follow(intent);
      force = std::max(force, reference.handle().force.norm());
      turn = std::max(turn, turn_between(intent.orientation, reference.tool().orientation).norm());
    }
    // Check that there are forces and rotations, because otherwise the comparison would not test anything.
    EXPECT_GT(force, 0.1);
    EXPECT_GT(turn, 1e-3);
    EXPECT_GT((stiff.handle().force - reference.handle().force).norm(), 1e-3);
  }
}
INSTANTIATE_TEST_SUITE_P(Scenes, GripAtTheForcePoint, testing::Values(0, 1, 2));

// ---- Predictions 3 and 4: a tight peg

TEST(TightPeg, HasNoForceButATorqueAndPenaltyLawsRenderAGhost) {
  // The hole has rings of points at a distance of 1 nm from the peg, so that the peg can tilt by 1e-6 rad.
  std::vector<SurfacePoint> points;
  for (int ring = 0; ring <= 20; ++ring)
    for (int k = 0; k < 32; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5) / 32;
      const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
      points.push_back({(kRadius + 1e-9) * out + Vec3(0.0, 0.0, 1e-4 + 2e-4 * ring), -out});
    }
  const PointShell shell(points, 0.0);
  const Cylinder tool(kRadius, kLength, Tip::flat);
  const double a = 0.03;
  const HandAndCoupling springs = with(kSprings, [&](auto& s) {
    s.coupling = 20000.0;
    s.force_point = a;
  });
  const double series = 20000.0 * 500.0 / 20500.0, rotation = springs.matched_rotation();
  for (const double pivot : {a, 0.0}) {
    SixDofDevice reference(shell, tool, springs, Skips::on);
    ThreeDofDevice shaping(shell, tool, springs, law("shaped_stiffness", 20000.0), 0.0005);
    double alpha = 0.0;
    for (int k = 0; k <= 100; ++k) {
      alpha = 5e-4 * k;
      const Intent intent = intent_of(springs, -pivot * Vec3(0.0, 0.0, -1.0) + Vec3(0.0, 0.0, -pivot), alpha, 0.0);
      Intent about = intent;
      // Rotate about a pivot on the axis, at the height `pivot` above the tip.
      about.grip = Vec3(0.0, 0.0, pivot) + (pivot - a) * (about.orientation * Vec3(0.0, 0.0, -1.0));
      ASSERT_TRUE(reference.follow(about).solved) << k;
      shaping.follow(about);
    }
    const Vec3 force = reference.handle().force, torque = reference.handle().torque;
    // The peg may tilt by 1e-6 rad in the hole. `free` bounds the lateral force [N] that this tilt can cause. Nothing
    // holds the peg in the axial direction, so the lateral force is compared with the closed form.
    const double free = 1e-6 * (series * a + rotation / a);
    EXPECT_NEAR(torque.norm(), rotation * alpha, 0.02 * rotation * alpha + 1e-6);
    if (pivot == a) {
      EXPECT_LE(force.norm(), free) << "F = 0 while T does not vanish";
      // The force F of the 6-DOF device is zero here, but the shaping law renders a force f. Its error is |F - f|. A
      // law that renders f = 0 would have the error 0.
      EXPECT_GT(shaping.handle().force.norm(), 100 * free);
    } else {
      EXPECT_NEAR(std::hypot(force.x(), force.y()), series * a * std::sin(alpha), free);
    }
  }
}

// ---- Prediction 5: a cycle of pressing by 1 mm, rotating by 0.1 rad, releasing, and rotating back

// NOLINTNEXTLINE(readability-function-cognitive-complexity): checks every pivot and angle.
TEST(OneContact, CreatesEnergyUnderEveryStiffness) {
  const double l = 0.03, press = 1e-3, angle = 0.1;
  // The hand is nearly rigid, so that the handle follows the pose that the hand intends.
  const HandAndCoupling rigid_hand = with(kSprings, [](auto& s) { s.hand = 1e8; });
  const OneContact contact(rigid_hand, l);
  for (const auto& [k, millijoules] : {std::pair{kInfinite, 6.0}, {0.4, 1.1}, {0.4 * 0.2 / 0.6, 0.41}}) {
    ThreeDofDevice device(contact.shell, contact.tool, rigid_hand, proxy(2000.0, k), 0.0005);
    double work = 0.0;
    Vec3 last_force = Vec3::Zero(), last_position = Vec3::Zero();
    for (int i = 0; i <= 400; ++i) {
      const double t = i / 100.0;
      const double pressed = t < 1 ? t : t < 2 ? 1 : t < 3 ? 3 - t : 0;
      const double turned = t < 1 ? 0 : t < 2 ? t - 1 : t < 3 ? 1 : 4 - t;
      // The hand rotates about the force point. The force point does not move during the rotation, so the force does no
      // work; the work appears only during the release.
      const Intent intent = intent_of(rigid_hand, Vec3(-press * pressed, 0.0, rigid_hand.force_point), angle * turned,
                                      rigid_hand.force_point);
      ASSERT_LE(device.follow(intent), kBalanced) << k << ' ' << i;
      const Handle& handle = device.handle();
      if (i > 0) work += 0.5 * (last_force + handle.force).dot(handle.position - last_position);
      last_force = handle.force;
      last_position = handle.position;
    }
    // After pressing by 1 mm, the rotation adds l sin(0.1) to the depth. During the release over 1 mm, the force is
    // larger than during the pressing by `stiffness` times l sin(0.1). The closed form uses the lever and the normal of
    // the upright drill. Its errors are: 1 - cos 0.1 = 0.5 %; sin(0.1) times radius / l = 0.2 %; and 1 % because the
    // normal rotates by 0.1 rad.
    const double stiffness = 1.0 / (1.0 / 2000.0 + l * l / k);
    EXPECT_NEAR(1e3 * work, 1e3 * stiffness * press * l * std::sin(angle), 0.03 * millijoules);
    EXPECT_NEAR(1e3 * work, millijoules, 0.05 * millijoules) << "as published, with two digits";
  }
}

// ---- Prediction 6: a hand that differs from the hand for which the proxy was matched

TEST(OneContact, IsWrongUnderAnotherHand) {
  for (const auto& [hand, ratio] : {std::pair{0.05, 2.93}, {1.0, 0.49}}) {
    const OneContact contact(with(kSprings,
                                  [hand = hand](auto& s) {
                                    s.coupling_rotation = kRigid;
                                    s.hand_rotation = hand;
                                  }),
                             0.03);
    const double found = contact.with(proxy(2000.0, 0.2)) / contact.reference();
    EXPECT_NEAR(found, contact.compliance() / contact.compliance_of_proxy(0.2), kLinear * ratio);
    EXPECT_NEAR(found, ratio, 0.005) << "as published, with two decimals";
  }
}

// Checks that the formula of springs in series is exact for isotropic stiffness and any rotation. It is not exact for
// different stiffness about different axes: at half a radian, the error is some tenths of a per cent.
TEST(SpringsInSeries, AreExactForIsotropicStiffnessOnly) {
  // Returns the smallest energy of two rotational springs A and B in series at a total rotation v. Gradient descent
  // finds the rotation between the springs.
  const auto smallest = [](const Vec3& A, const Vec3& B, const Vec3& v) {
    Vec3 w = 0.5 * v;
    const auto energy = [&](const Vec3& u) {
      const Vec3 rest = turn_between(turn_by(u), turn_by(v));
      return 0.5 * u.dot(A.cwiseProduct(u)) +
             0.5 * (turn_by(u).conjugate() * rest).dot(B.cwiseProduct(turn_by(u).conjugate() * rest));
    };
    double step = 0.1;
    while (step > 1e-9) {
      bool better = false;
      for (int k = 0; k < 6; ++k) {
        const Vec3 next = w + (k < 3 ? step : -step) * Vec3::Unit(k % 3);
        if (energy(next) < energy(w)) {
          w = next;
          better = true;
        }
      }
      if (!better) step *= 0.5;
    }
    return energy(w);
  };
  const Vec3 v = 0.5 * Vec3(0.5, -0.7, 0.6).normalized();
  const auto series = [&](const Vec3& A, const Vec3& B) {
    return 0.5 * v.dot(A.cwiseProduct(B).cwiseQuotient(A + B).cwiseProduct(v));
  };
  const Vec3 a(0.4, 0.4, 0.4), b(0.2, 0.2, 0.2);
  EXPECT_NEAR(smallest(a, b, v) / series(a, b), 1.0, 1e-12);
  const Vec3 c(0.4, 0.2, 0.6), d(0.1, 0.3, 0.2);
  const double error = std::abs(smallest(c, d, v) / series(c, d) - 1.0);
  EXPECT_GT(error, 5e-4);
  EXPECT_LT(error, 2e-2);
}

// ---- The reference device

// Checks that a closed path without jumps creates no energy, for two positions of the grip. The force and the torque of
// the 6-DOF device are the derivatives of a potential.
TEST(SixDofDevice, CreatesNoEnergyOnAClosedPath) {
  const PointShell shell(surface_points(Plane{.size = 0.004}), 0.0);
  const Cylinder tool(kRadius, kLength, Tip::flat);
  for (const double grip : {0.0, -0.01}) {
    const HandAndCoupling springs = with(kSprings, [grip](auto& s) { s.grip = grip; });
    SixDofDevice device(shell, tool, springs, Skips::on);
    double work = 0.0, moved = 0.0;
    Handle last;
    constexpr int kSteps = 400;
    for (int k = 0; k <= kSteps; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSteps;
      const Intent intent =
          intent_of(springs, {0.0026 - 0.0006 * (1 - std::cos(angle)) / 2, 5e-5, -0.004}, 0.05 * std::sin(angle));
      ASSERT_TRUE(device.follow(intent).solved);
      const Handle& handle = device.handle();
      if (k > 0) {
        work += 0.5 * (last.force + handle.force).dot(handle.position - last.position) +
                0.5 * (last.torque + handle.torque).dot(turn_between(last.orientation, handle.orientation));
        moved += std::abs(0.5 * (last.force + handle.force).dot(handle.position - last.position));
      }
      last = handle;
    }
    EXPECT_GT(moved, 1e-6);
    // The work is computed by the trapezoidal rule with 400 steps over an angle of 2 pi. Its relative error is about
    // (2 pi / 400)^2 / 12 = 2e-5.
    EXPECT_LE(std::abs(work), 1e-3 * moved);
  }
}

TEST(SixDofDevice, AllocatesNothingAndRepeatsItself) {
  const PointShell shell(surface_points(Plane{.size = 0.004}), 0.0);
  const Cylinder tool(kRadius, kLength, Tip::flat);
  SixDofDevice device(shell, tool, kSprings, Skips::on);
  ThreeDofDevice law_device(shell, tool, kSprings, proxy(2000.0, 0.1), 0.0005);
  const auto force = [&] {
    device.reset();
    law_device.reset();
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k <= 50; ++k) {
      const Intent intent = intent_of(kSprings, {0.0026 - 1e-5 * k, 5e-5, -0.004}, 1e-3 * k);
      device.follow(intent);
      law_device.follow(intent);
      sum += device.handle().force + law_device.handle().force;
    }
    return sum;
  };
  const AllocationCount allocations;
  const Vec3 first = force();
  EXPECT_EQ(allocations.value(), 0u);
  EXPECT_GT(first.norm(), 0.0);
  EXPECT_EQ(force(), first);
}

// Presses an upright drill by 1.5 radii against points at the height of its force point, so that the drill does not
// rotate. Returns the tool's position at the end.
Vec3 pressed_against(const std::vector<SurfacePoint>& points) {
  const PointShell shell(points, 0.0);
  const Cylinder tool(kRadius, kLength, Tip::flat);
  const HandAndCoupling springs = with(kSprings, [](auto& s) { s.force_point = 0.005; });
  SixDofDevice device(shell, tool, springs, Skips::on);
  for (int k = -1; k <= 68; ++k)
    EXPECT_TRUE(device.follow(intent_of(springs, {-1.1e-5 * k, 0.0, 0.0}, 0.0)).solved) << k;
  return device.tool().position;
}

// Checks that the drill leaves a saddle of the energy. Against one point, the drill slides off sideways when the force
// exceeds K' r, and the pose without a sideways displacement is then a saddle. The drill moves around the point to the
// other side of the point, where the point no longer blocks the drill.
TEST(SixDofDevice, LeavesASaddle) {
  const Vec3 position = pressed_against({{{-kRadius, 0.0, 0.005}, {1.0, 0.0, 0.0}}});
  EXPECT_LE((position - Vec3(-2 * kRadius, 0.0, 0.005)).norm(), 1e-9);
}

// Checks two points 1 um apart, which form a notch. The drill rests in the notch at any force, because each point
// blocks the motion in one direction. The normals of the points differ by only 2e-3 rad. The energy increases only for
// sideways displacements of up to a fraction of a micrometre, and decreases for larger displacements.
TEST(SixDofDevice, RestsInAShallowNotch) {
  const double angle = 1e-3;
  std::vector<SurfacePoint> points;
  for (const double side : {1.0, -1.0}) {
    const Vec3 normal(std::cos(angle), side * std::sin(angle), 0.0);
    points.push_back({Vec3(0.0, 0.0, 0.005) - kRadius * normal, normal});
  }
  EXPECT_LE((pressed_against(points) - Vec3(0.0, 0.0, 0.005)).norm(), 1e-9);
}

// Checks a slot that is narrower than the tool: no pose satisfies all constraints.
TEST(SixDofDevice, ReportsThatThereIsNoRoom) {
  const PointShell shell(surface_points(Slot{.gap = 0.0009, .depth = 0.004, .length = 0.004}), 0.0);
  const Cylinder tool(kRadius, kLength, Tip::flat);
  SixDofDevice device(shell, tool, kSprings, Skips::on);
  EXPECT_FALSE(device.follow(intent_of(kSprings, {0.0, 5e-5, -0.003}, 0.0)).solved);
}

}  // namespace
}  // namespace hapbench::six_dof
