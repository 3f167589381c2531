#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "device_model/hands/drag_hand.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "device_model/hands/tracking_hand.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"

namespace hapbench::hands_test {
namespace {

/// Owns the states to which a HandView refers.
struct Seen {
  HandleState handle;
  ToolPose tool;
  Vec3 model_force = Vec3::Zero(), spring_force = Vec3::Zero();
  operator HandView() const { return {handle, tool, model_force, spring_force}; }
};

TEST(PushDirection, LeansFromStraightDownTowardsItsAzimuth) {
  EXPECT_EQ(push_direction(0.0, 1.0), Vec3(0, 0, -1));
  const double eps = 4 * std::numeric_limits<double>::epsilon(), pi = std::numbers::pi;
  EXPECT_LE((push_direction(pi / 2, 0.0) - Vec3::UnitX()).norm(), eps);
  EXPECT_LE((push_direction(pi / 2, pi / 2) - Vec3::UnitY()).norm(), eps);
  EXPECT_LE((push_direction(pi / 6, pi) - Vec3(-0.5, 0.0, -std::sqrt(0.75))).norm(), eps);
  for (const double angle : {-3.0, 0.3, 1.0, 2.0}) {
    for (const double azimuth : {-2.0, 0.0, 5.0}) EXPECT_NEAR(push_direction(angle, azimuth).norm(), 1.0, eps);
  }
}

TEST(ImpedanceHand, IsASpringAndADamperFromTargetToHandle) {
  ImpedanceHand hand(100.0, 10.0, {Profile::Shape(Profile::Ramp{1.0, 2.0}), 5.0, 0.0});
  const Seen seen{{{1, 5, -1}, {2, 0, 3}}, {}, {9, 9, 9}};
  // At t = 3 the target is at x = 7 and moves at 2 m/s.
  EXPECT_EQ(hand.force(3.0, seen), Vec3(100 * 6 + 10 * 0, 0, 100 * 1 - 10 * 3));
}

/// Checks the mean square and the frequency over ten minutes. The mean square of eight tones equals the sum of the mean
/// squares of the tones to 1 %: a beat between two tones either has a period below ten seconds, or contributes less
/// than 1 %.
TEST(Tremor, HasItsStandardDeviationInItsBandAlone) {
  const Tremor tremor({{20e-6, 0.0, 5e-6}, 8.0, 12.0}, 3);
  constexpr double kStep = 0.005;
  double squares = 0.0, speeds = 0.0;
  int turns = 0, count = 0;
  for (double t = 0.0; t < 600.0; t += kStep, ++count) {
    const auto [x, v] = tremor.at(t);
    squares += x.x() * x.x();
    speeds += v.x() * v.x();
    turns += (x.x() > 0.0) != (tremor.at(t + kStep).position.x() > 0.0) ? 1 : 0;
    EXPECT_EQ(x.y(), 0.0);
  }
  EXPECT_NEAR(std::sqrt(squares / count), 20e-6, 0.2e-6);
  const double rate = std::sqrt(speeds / squares) / (2.0 * std::numbers::pi);  // rms frequency [Hz]
  EXPECT_GT(rate, 8.0);
  EXPECT_LT(rate, 12.0);
  EXPECT_NEAR(turns / 600.0 / 2.0, rate, 0.5);
}

TEST(Tremor, MovesTheTargetOfAHandAsItsSeedSays) {
  const TremorConfig config{{1e-4, 1e-4, 1e-4}, 8.0, 12.0};
  const Tremor tremor(config, 1);
  ImpedanceHand still(100.0, 10.0, {0.0, 0.0, 0.0}), shaky(100.0, 10.0, {0.0, 0.0, 0.0}, tremor);
  const double t = 0.37, h = 1e-6;
  const auto [x, v] = tremor.at(t);
  EXPECT_LE((shaky.force(t, Seen{}) - still.force(t, Seen{}) - 100.0 * x - 10.0 * v).norm(), 1e-15);
  // The central difference of the position has the error h^2 / 6 times the third derivative, 43 m/s^3, plus the
  // rounding error divided by h.
  EXPECT_LE(((tremor.at(t + h).position - tremor.at(t - h).position) / (2.0 * h) - v).norm(), 1e-10);
  EXPECT_EQ(Tremor(config, 1).at(t).position, x);
  EXPECT_NE(Tremor(config, 2).at(t).position, x);
}

constexpr double kSmoothing = 0.0005;

/// Returns points distributed evenly over a sphere around the origin, on a spiral of golden angles.
std::vector<SurfacePoint> sphere(double radius, int count) {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double rho = std::sqrt(1.0 - z * z);
    const Vec3 normal(rho * std::cos(turn), rho * std::sin(turn), z);
    points.push_back({radius * normal, normal});
  }
  return points;
}

TEST(SmoothedSurface, OfAPlaneIsThePlane) {
  const PointShell shell(surface_points(Plane{0.004, 0.0001}), 0.0001);
  const SmoothedSurface surface(shell, kSmoothing);
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Vec3 at = 0.002 * random.direction();
    const SurfacePoint found = surface.nearest(at);
    // All points have z = 0 and equal normals, so the averages are exact up to the division of equal sums.
    EXPECT_LT((found.normal - Vec3(0, 0, 1)).norm(), 1e-15);
    EXPECT_LT((found.position - Vec3(at.x(), at.y(), 0)).norm(), 1e-18) << at.transpose();
  }
}

TEST(SmoothedSurface, OfASphereFollowsIt) {
  constexpr double kRadius = 0.005;
  const PointShell shell(sphere(kRadius, 20'000), 0.0);
  const SmoothedSurface surface(shell, kSmoothing);
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Vec3 radial = random.direction();
    const SurfacePoint found = surface.nearest((kRadius + 0.001 * random.uniform()) * radial);
    // Let R be the smoothing radius and r the radius of the sphere. The neighbours lie within R of a position near the
    // sphere. Therefore neither a normal of a neighbour nor the mean of the normals differs from the radial direction
    // by more than the angle 2 asin(R / 2r), and the centre of the neighbours is no deeper than R^2 / 2r.
    EXPECT_LT(std::acos(std::min(1.0, found.normal.dot(radial))), 2.0 * std::asin(kSmoothing / (2.0 * kRadius)));
    EXPECT_NEAR(found.position.norm(), kRadius, kSmoothing * kSmoothing / (2.0 * kRadius));
  }
}

TEST(SmoothedSurface, DoesNotSeeTheFarSideOfAThinWall) {
  std::vector<SurfacePoint> points = surface_points(Plane{0.004, 0.0001});
  for (std::size_t i = 0, n = points.size(); i < n; ++i)
    points.push_back({points[i].position - Vec3(0, 0, 0.0001), {0, 0, -1}});
  const PointShell shell(points, 0.0001);
  const SurfacePoint found = SmoothedSurface(shell, kSmoothing).nearest({0.0003, 0.0002, 0.0001});
  EXPECT_LT((found.normal - Vec3(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT(std::abs(found.position.z()), 1e-18);
}

TEST(SmoothedSurface, EndsWithTheShell) {
  const PointShell shell(surface_points(Plane{0.004, 0.0001}), 0.0001);
  const SmoothedSurface surface(shell, kSmoothing);
  EXPECT_LT((surface.nearest({0.9, 0, 0.3}).position - Vec3(0.002, 0, 0)).norm(), 1e-15);
  // A position up to the smoothing radius beyond the border of the plane still has the plane's last points as
  // neighbours.
  EXPECT_LT((surface.nearest({0.0024, 0, 0.0001}).position - Vec3(0.0024, 0, 0)).norm(), 1e-15);
}

/// Fixture with a plane and paths over it.
class DragOnPlane : public testing::Test {
 protected:
  std::shared_ptr<const SurfacePath> over(std::vector<Vec3> points) const {
    return std::make_shared<const SurfacePath>(SurfacePath::over(surface_, points));
  }
  std::shared_ptr<const SurfacePath> along(const Vec3& start, const Vec3& direction, double length) const {
    return std::make_shared<const SurfacePath>(SurfacePath::along(surface_, start, direction, length));
  }

  const PointShell shell_{surface_points(Plane{0.004, 0.0001}), 0.0001};
  const SmoothedSurface surface_{shell_, kSmoothing};
};

TEST_F(DragOnPlane, PathGoesThroughItsPointsBelowThem) {
  const auto path = over({{-0.001, 0, 0.0003}, {0.001, 0, 0.0003}, {0.001, 0.001, -0.0002}});
  EXPECT_NEAR(path->length(), 0.003, 1e-15);
  EXPECT_NEAR((path->at(0.0).position - Vec3(-0.001, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((path->at(0.00123).position - Vec3(0.00023, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((path->at(0.0027).position - Vec3(0.001, 0.0007, 0)).norm(), 0.0, 1e-15);
  EXPECT_EQ(path->at(1.0).position, path->at(path->length()).position);
  EXPECT_EQ(path->at(-1.0).position, path->at(0.0).position);
}

TEST_F(DragOnPlane, DirectionTurnsSteadilyAroundACorner) {
  const auto path = over({{-0.001, 0, 0}, {0.001, 0, 0}, {0.001, 0.001, 0}});
  EXPECT_NEAR((path->direction(0.001) - Vec3(1, 0, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((path->direction(0.002) - Vec3(1, 1, 0).normalized()).norm(), 0.0, 1e-9);
  EXPECT_NEAR((path->direction(0.0027) - Vec3(0, 1, 0)).norm(), 0.0, 1e-12);
}

TEST_F(DragOnPlane, PathAlongADirectionEndsAtTheEdge) {
  const auto path = along({0.001, 0, 0.002}, {2, 0, -5}, 1.0);
  // The path continues in the plane beyond the last points, as long as a point is within the smoothing radius.
  EXPECT_GT(path->length(), 0.001 - 1e-12);
  EXPECT_LT(path->length(), 0.001 + kSmoothing);
  EXPECT_NEAR(path->at(0.0005).position.x(), 0.0015, 1e-12);
  EXPECT_NEAR(along({0, 0, 0}, {1, 0, 0}, 0.001)->length(), 0.001, 1.01 * SurfacePath::spacing(kSmoothing));
  EXPECT_EQ(along({0, 0, 0}, {0, 0, 1}, 0.001)->length(), 0.0) << "no way on along the normal";
}

TEST(SurfacePath, AlongADirectionStartsFromFarAboveARoughSurface) {
  // The surface has waves with an amplitude of 0.1 mm along x and along y, which are shorter than the smoothing radius.
  // The path starts 2 mm above the surface. The first projection of this start does not lie on the surface.
  constexpr double kWave = 2.0 * std::numbers::pi / 0.0003, kHeight = 0.0001;
  std::vector<SurfacePoint> points;
  for (int i = -40; i <= 40; ++i) {
    for (int j = -40; j <= 40; ++j) {
      const double x = 5e-5 * i, y = 5e-5 * j;
      const Vec3 normal(-kHeight * kWave * std::cos(kWave * x), -kHeight * kWave * std::cos(kWave * y), 1.0);
      const double z = kHeight * (std::sin(kWave * x) + std::sin(kWave * y));
      points.push_back({Vec3(x, y, z), normal.normalized()});
    }
  }
  const PointShell shell(points, 0.0);
  const SmoothedSurface surface(shell, kSmoothing);
  for (int i = -3; i <= 3; ++i)
    EXPECT_GT(SurfacePath::along(surface, {1e-4 * i, 1e-4, 0.002}, {1, 0, 0}, 0.001).length(), 0.0009) << i;
}

TEST_F(DragOnPlane, PushesAlongTheNormalAndPullsWithinTheSurface) {
  const Drag drag{.force = 2.0, .speed = 0.01, .stiffness = 100.0, .damping = 10.0, .normal_damping = 50.0};
  DragHand hand(drag, over({{-0.001, 0, 0}, {0.001, 0, 0}}));
  const Vec3 x(-0.0004, 0.0002, 0.0005), v(0.003, -0.001, -0.02);
  // At t = 0.05 s the moving point is at x = -0.5 mm.
  const Vec3 expected(100.0 * -0.0001 + 10.0 * (0.01 - 0.003), 100.0 * -0.0002 + 10.0 * 0.001, -2.0 + 50.0 * 0.02);
  EXPECT_LT((hand.force(0.05, Seen{{x, v}, {}, {}}) - expected).norm(), 1e-12);
  // When the moving point has reached the end of the path, the point rests.
  EXPECT_LT((hand.force(1.0, Seen{{{0.001, 0, 0.0005}, {0, 0, 0}}, {}, {}}) - Vec3(0, 0, -2)).norm(), 1e-12);
}

TEST_F(DragOnPlane, AxisLeansFromTheNormalTowardsTheTravel) {
  const auto path = over({{-0.001, 0, 0}, {0.001, 0, 0}});
  const auto axis = [&](double tilt, double azimuth) {
    return DragOrientation(path, 0.01, tilt, azimuth).axis_at(0.1);
  };
  EXPECT_LT((axis(0.0, 0.0) - Vec3(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((axis(0.3, 0.0) - Vec3(-std::sin(0.3), 0, -std::cos(0.3))).norm(), 1e-12);
  // The azimuth turns the lean about the normal by the right-hand rule: at a quarter turn, the rear end of the tool
  // leans to the left of the direction of travel.
  EXPECT_LT((axis(0.3, std::acos(0.0)) - Vec3(0, -std::sin(0.3), -std::cos(0.3))).norm(), 1e-12);
}

constexpr double kStep = 1.0 / 2048;

Subject without_tremor() {
  Subject subject;
  subject.motor_noise = subject.tilt_noise = 0.0;
  return subject;
}

TargetTask one_target(TargetDisplay display, const Vec3& position) {
  TargetRules rules;
  rules.display = display;
  rules.positions = {position};
  rules.targets_per_position = 1;
  return {rules, 1};
}

TEST(TrackingHand, DoesNothingBeforeTheReactionDelay) {
  const Subject subject = without_tremor();
  TrackingHand hand(subject, one_target(TargetDisplay::panel, {0.01, 0, 0}), 0.0, kStep, 1);
  const Seen view{{}, {}, {0, 0, subject.press}};  // no correction needed in z
  const int delay = static_cast<int>(std::lround(subject.reaction_delay / kStep));
  double first_force = -1.0;
  for (int i = 0; i <= delay; ++i) {
    const Vec3 force = hand.force(i * kStep, view);
    if (force.x() != 0.0) {
      first_force = i;
      break;
    }
  }
  EXPECT_EQ(first_force, delay);
}

TEST(TrackingHand, MovesTowardsTheTargetAtTheBandwidthOfTheSubject) {
  Subject subject = without_tremor();
  subject.reaction_delay = 0.0;
  const double error = 0.001;
  TrackingHand hand(subject, one_target(TargetDisplay::panel, {error, -error, 0}), 0.0, kStep, 1);
  const Seen view{{}, {}, {0, 0, subject.press}};
  const Vec3 force = hand.force(0.0, view);
  const double step = 2.0 * std::numbers::pi * subject.bandwidth * error * kStep;
  EXPECT_NEAR(force.x(), subject.stiffness * step, 1e-12);
  EXPECT_NEAR(force.y(), -subject.stiffness * step, 1e-12);
  EXPECT_EQ(force.z(), 0.0);
}

TEST(TrackingHand, PressesHarderOrSofterUntilTheGaugeShowsWhatItWants) {
  Subject subject = without_tremor();
  subject.reaction_delay = 0.0;
  for (const double shown : {0.0, subject.press + 1.0}) {
    TrackingHand hand(subject, one_target(TargetDisplay::panel, {0, 0, 0}), 0.0, kStep, 1);
    const Seen view{{}, {}, {0, 0, shown}};
    const double force = hand.force(0.0, view).z();
    const double change = -2.0 * std::numbers::pi * subject.press_bandwidth * (subject.press - shown) * kStep;
    EXPECT_NEAR(force, change, 1e-12) << "downwards when too little is shown";
  }
}

TEST(TrackingHand, ReadsTheSpringForceFromAGaugeAndTheRenderedForceWithoutOne) {
  const Seen view{{}, {}, {0, 0, 3.0}, {0, 0, 2.0}};
  TargetRules rules;
  rules.positions = {Vec3(0, 0, 0)};
  for (const bool has_gauge : {false, true}) {
    if (has_gauge) rules.gauge = Gauge{1e6, 0.1};  // so fast that it filters nothing
    TrackingHand hand(without_tremor(), TargetTask(rules, 1), 0.0, kStep, 1);
    hand.force(0.0, view);
    EXPECT_EQ(hand.task()->reading(), has_gauge ? 2.0 : 3.0);
  }
}

TEST(TrackingHand, TurnsTheToolOnlyWithTheHeightDisplay) {
  Subject subject = without_tremor();
  subject.reaction_delay = 0.0;
  const double rise = 0.001;
  TrackingHand panel(subject, one_target(TargetDisplay::panel, {0, 0, rise}), 0.5, kStep, 1);
  TrackingHand height(subject, one_target(TargetDisplay::height, {0.3, 0.3, rise}), 0.5, kStep, 1);
  const Vec3 force = height.force(0.0, Seen{});
  panel.force(0.0, Seen{});
  EXPECT_EQ(panel.tilt(), 0.5);
  const double turn = 2.0 * std::numbers::pi * subject.bandwidth * rise / subject.height_per_tilt * kStep;
  EXPECT_NEAR(height.tilt(), 0.5 + turn, 1e-15) << "the tip rises with the tilt";
  EXPECT_EQ(force.x(), 0.0) << "what is not on display does not count";
}

TEST(TrackingHand, NoiseHasTheGivenDeviationAndBandwidth) {
  Subject subject;
  subject.bandwidth = subject.press_bandwidth = 0.0;  // no motion except noise
  subject.motor_noise = 0.5;
  subject.noise_bandwidth = 8.0;
  TargetRules rules;
  rules.positions = {Vec3(0, 0, 0)};
  rules.time_limit = 1e6;
  TrackingHand hand(subject, TargetTask(rules, 1), 0.0, kStep, 7);
  double squares = 0.0, products = 0.0, last = 0.0;
  constexpr int kSamples = 400'000;
  for (int i = 0; i < kSamples; ++i) {
    const double x = hand.force(i * kStep, Seen{}).x();
    squares += x * x;
    products += x * last;
    last = x;
  }
  const double memory = std::exp(-2.0 * std::numbers::pi * subject.noise_bandwidth * kStep);
  // Let a (`memory`) be the correlation of successive samples. A sum of the squares of n samples is as accurate as a
  // sum of the squares of n (1 - a^2) / (1 + a^2) independent samples. Allow five standard errors.
  const double independent = kSamples * (1.0 - memory * memory) / (1.0 + memory * memory);
  EXPECT_NEAR(squares / kSamples / 0.25, 1.0, 5.0 * std::sqrt(2.0 / independent));
  // 1 - products / squares estimates 1 - a with relative error about sqrt(2 / (n (1 - a))).
  EXPECT_NEAR((1.0 - products / squares) / (1.0 - memory), 1.0, 5.0 * std::sqrt(2.0 / (kSamples * (1.0 - memory))));
}

TEST(TrackingHand, AResetRepeatsEverythingBitForBitAndASeedChangesIt) {
  const auto record = [](TrackingHand& hand) {
    std::vector<Vec3> forces;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 position(1e-4 * std::sin(0.01 * i), 0.0, 0.0);
      forces.push_back(hand.force(i * kStep, Seen{{position}, {position}, {0, 0, 1.2}}));
    }
    return forces;
  };
  TrackingHand hand({}, one_target(TargetDisplay::height, {0, 0, 0.001}), 0.3, kStep, 11);
  const auto first = record(hand);
  hand.reset();
  EXPECT_EQ(record(hand), first);
  TrackingHand other({}, one_target(TargetDisplay::height, {0, 0, 0.001}), 0.3, kStep, 12);
  EXPECT_NE(record(other), first);
}

}  // namespace
}  // namespace hapbench::hands_test
