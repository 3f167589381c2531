#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/motion.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::depth_models_test {
namespace {

using test::Vec3L;

struct Contact {
  double depth;
  Vec3 gradient;
};

Contact evaluate(const Cylinder& tool, const ToolPose& pose, const Vec3& point, const Vec3& normal = Vec3::UnitY()) {
  ContactBuffer contacts(1);
  contacts.push(0, point, normal);
  make_depth_model("shortest_distance")->evaluate(tool, pose, contacts);
  return {contacts.depth[0], contacts.gradient(0)};
}

// All lengths are multiples of a power of two, and the tool's axis is a coordinate axis. Therefore every distance below
// is computed without rounding, and distances that are equal in theory are bitwise equal.
constexpr double kUnit = 0x1p-13;  // 0.12 mm
const Vec3 kAxis(0, 0, -1);
const ToolPose kPose{{0x1p-4, 0x1p-5, 0x1p-6}, kAxis}, kOrigin{Vec3::Zero(), kAxis};

/// Returns the point at the distance s along the axis from the tip centre of kPose, and at the distance a along +x. s
/// and a are in units of kUnit.
Vec3 at(double s, double a) {
  return kPose.position + kUnit * (s * kAxis + Vec3(a, 0, 0));
}

TEST(ShortestDistance, AnUndefinedDirectionFallsBackToTheInwardNormal) {
  const Vec3 normal = Vec3(3, 4, 0) / 5;
  // On the axis, the side is the nearest surface, but the direction towards the side is undefined.
  const Cylinder flat{kUnit, 16 * kUnit, Tip::flat};
  const auto on_axis = evaluate(flat, kPose, at(-8, 0), normal);
  EXPECT_EQ(on_axis.depth, kUnit);
  EXPECT_EQ(on_axis.gradient, Vec3(-normal));
  // At the centre of a round tip, the direction is also undefined. The first point (s = 0) belongs to the cylindrical
  // part, the second point to the hemisphere.
  const Cylinder round{kUnit, 16 * kUnit, Tip::round};
  EXPECT_EQ(evaluate(round, kPose, at(0, 0), normal).gradient, Vec3(-normal));
  EXPECT_EQ(evaluate(round, kOrigin, 1e-13 * kUnit * kAxis, normal).gradient, Vec3(-normal));
}

TEST(ShortestDistance, DirectionsLongerThan1e12thOfTheRadiusAreDefined) {
  const Vec3 normal = Vec3(3, 4, 0) / 5;
  for (const Tip tip : {Tip::flat, Tip::round}) {
    const Cylinder tool{kUnit, 16 * kUnit, tip};
    const Vec3 middle = 8 * kUnit * -kAxis;
    EXPECT_EQ(evaluate(tool, kOrigin, middle + Vec3(1.01e-12 * kUnit, 0, 0), normal).gradient, Vec3(1, 0, 0));
    EXPECT_EQ(evaluate(tool, kOrigin, middle + Vec3(0.99e-12 * kUnit, 0, 0), normal).gradient, Vec3(-normal));
  }
}

/// Calls check(tool, pose, shell, contacts) with random cylinders, with flat and with round tips. The shell has points
/// in, on and around the tool.
template <class Check>
void for_tools(std::size_t n, Check check) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(n); ++i) {
    const test::DefinedTool tool = test::tool_kinds()[i % 2].make(random, 0.001);
    const ToolPose pose = test::random_pose(random);
    std::vector<SurfacePoint> points;
    while (points.size() < 100) {
      points.push_back({tool.surface_point(pose, random), random.direction()});
      points.push_back({tool.near_point(pose, random), random.direction()});
    }
    const PointShell shell(points, 0.0);
    const auto query = make_contact_query(shell, *tool.shape, Skips::off);
    ContactBuffer contacts(query->capacity());
    query->contacts_at(pose, contacts);
    check(*tool.shape, pose, shell, contacts);
  }
}

TEST(SurfaceNormal, HasTheDepthOfShortestDistanceAndTheInwardNormalAsGradient) {
  for_tools(400, [](const ToolShape& tool, const ToolPose& pose, const PointShell&, ContactBuffer& contacts) {
    ContactBuffer shortest = contacts;
    make_depth_model("surface_normal")->evaluate(tool, pose, contacts);
    make_depth_model("shortest_distance")->evaluate(tool, pose, shortest);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts.depth[i], shortest.depth[i]);
      EXPECT_EQ(contacts.gradient(i), Vec3(-contacts.normal(i)));
    }
  });
}

TEST(EveryDepthModel, NeverGivesACollidingPointANegativeDepth) {
  for (const DepthModelEntry& model : depth_models()) {
    SCOPED_TRACE(model.info->name);
    std::size_t on_surface = 0;
    for_tools(4000, [&](const ToolShape& tool, const ToolPose& pose, const PointShell& shell, ContactBuffer& contacts) {
      const auto made = model.make();
      made->prepare(shell);
      made->evaluate(tool, pose, contacts);
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        ASSERT_GE(contacts.depth[k], 0.0);
        ASSERT_TRUE(std::isfinite(contacts.depth[k]));
        on_surface += contacts.depth[k] < 1e-15;
      }
    });
    // Check that many points lay on the tool's surface, where the search and the model could round differently.
    EXPECT_GT(on_surface, test::cases(4000));
  }
}

double depth_at(const ToolShape& tool, const ToolPose& pose, const Vec3& point, const Vec3& normal) {
  ContactBuffer contacts(1);
  contacts.push(0, point, normal);
  make_depth_model("normal_projection")->evaluate(tool, pose, contacts);
  EXPECT_EQ(contacts.gradient(0), Vec3(-normal));
  return contacts.depth[0];
}

/// Returns true if the contact search reports the point. A depth model receives only points that the search reports.
bool collides(const ToolShape& tool, const ToolPose& pose, const Vec3& point) {
  const PointShell shell({{point, Vec3::UnitZ()}}, 0.0);
  const auto query = make_contact_query(shell, tool, Skips::off);
  ContactBuffer contacts(query->capacity());
  query->contacts_at(pose, contacts);
  return !contacts.empty();
}

/// Returns the two kinds of cylinders: with flat and with round tips.
std::span<const test::ToolKind> cylinders() {
  return test::tool_kinds().first(2);
}

class NormalProjectionDepthOf : public testing::TestWithParam<test::ToolKind> {};
INSTANTIATE_TEST_SUITE_P(Both, NormalProjectionDepthOf, testing::ValuesIn(cylinders().begin(), cylinders().end()),
                         [](const auto& kind) { return kind.param.name; });

/// Checks that the ray from the point against its normal leaves the tool at the distance `depth`. The slack of a point
/// is its distance from the body's surface, positive inside the body. Along the ray, the slack must be >= 0 before the
/// distance `depth`, 0 at `depth`, and <= 0 after `depth`. `rounding` is the rounding error of a slack [m]: a few
/// roundings of coordinates up to 1 m.
void expect_exit(const test::DefinedTool& tool, const ToolPose& pose, const Vec3& point, const Vec3& normal,
                 double depth) {
  constexpr long double rounding = 2e-15L;
  const Vec3L x = point.cast<long double>(), u = -normal.cast<long double>();
  const auto slack_at = [&](long double d) { return tool.slack(pose, x + d * u); };
  ASSERT_GE(depth, 0.0);
  ASSERT_LE(std::abs(slack_at(depth)), rounding);
  // The slack is concave along the ray. Therefore two points suffice: the ray must be inside at half of `depth`, and
  // outside a little after `depth`.
  ASSERT_GE(slack_at(0.5L * depth), -rounding);
  ASSERT_LE(slack_at(depth + 0.001L * tool.shape->half_width()), rounding);
}

TEST_P(NormalProjectionDepthOf, ARayInwardsFromTheSurfaceCrossesTheTool) {
  // The result must not depend on the side of the surface to which rounding has moved the point.
  Random random(2);
  std::size_t inwards = 0;
  for (std::size_t i = 0; i < test::cases(100000); ++i) {
    const test::DefinedTool tool = GetParam().make(random, 0.001);
    const ToolPose pose = test::random_pose(random);
    const Vec3 point = tool.surface_point(pose, random), normal = random.direction();
    const double little = 0.001 * tool.shape->half_width();
    const Vec3L a_little_on = point.cast<long double>() - little * normal.cast<long double>();
    if (!collides(*tool.shape, pose, point) || tool.slack(pose, a_little_on) < 1e-12L) continue;
    ++inwards;
    const double depth = depth_at(*tool.shape, pose, point, normal);
    ASSERT_GE(depth, little);
    expect_exit(tool, pose, point, normal, depth);
  }
  EXPECT_GT(inwards, test::cases(100000) / 8);
}

TEST_P(NormalProjectionDepthOf, HandlesRaysAlongAndAcrossTheAxis) {
  // Checks rays for which the denominator of equation (F.7) or (F.12) of the thesis is zero or nearly zero.
  Random random(3);
  for (std::size_t i = 0; i < test::cases(20000); ++i) {
    const test::DefinedTool tool = GetParam().make(random, 0.001);
    const ToolPose pose{Vec3::Zero(), random.uniform() < 0.5 ? Vec3(0, 0, -1) : Vec3(1, 0, 0)};
    const Vec3 point = tool.near_point(pose, random);
    if (tool.slack(pose, point.cast<long double>()) < 0.0L) continue;
    const double tiny = std::pow(10.0, random.uniform(-18.0, -3.0));
    for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, 1, 0)}) {
      expect_exit(tool, pose, point, direction, depth_at(*tool.shape, pose, point, direction));
      const Vec3 nearly = (direction + tiny * random.direction()).normalized();
      expect_exit(tool, pose, point, nearly, depth_at(*tool.shape, pose, point, nearly));
    }
  }
}

TEST(NormalProjectionDepth, OnlyPositiveExitsCount) {
  // Equation (F.1) of the thesis takes the smallest positive distance at which the ray meets one of the infinite
  // surfaces of (F.7), (F.9) and (F.12). A ray that points outwards from a point exactly on a surface has already
  // passed this surface. The ray meets another of these surfaces beyond the body, or no surface.
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  EXPECT_EQ(depth_at(tool, kOrigin, {4 * kUnit, 0, 8 * kUnit}, {-1, 0, 0}), 0.0) << "side, straight out: none left";
  EXPECT_EQ(depth_at(tool, kOrigin, {kUnit, 0, 0}, {0, 0, 1}), 0.0) << "tip, straight out: none left";
  // A ray from the tip plane moves 3 units sideways for 4 units downwards. It meets the side wall, continued beyond the
  // tip, after 5 units.
  EXPECT_NEAR(depth_at(tool, kOrigin, {kUnit, 0, 0}, {-0.6, 0, 0.8}), 5 * kUnit, 4e-16 * kUnit * 16);
}

TEST(NormalProjectionDepth, IsNeverLongerThanTheTool) {
  // Rays at the angle `angle` to the axis meet the side wall, continued beyond the tool, at a distance proportional to
  // 1 / sin(angle). This distance exceeds the length of the tool if the angle is small.
  for (const Tip tip : {Tip::flat, Tip::round}) {
    const Cylinder tool{4 * kUnit, 16 * kUnit, tip};
    const double longest = tool.length() + 3.0 * tool.radius();  // longer than the longest path through the body
    for (double angle = 1.0; angle > 1e-18; angle *= 0.5) {
      for (const double down : {1.0, -1.0}) {
        const Vec3 normal(-std::sin(angle), 0, down * std::cos(angle));
        for (const double height : {0.0, 16 * kUnit}) {
          const double depth = depth_at(tool, kOrigin, {kUnit, 0, height}, normal);
          EXPECT_GE(depth, 0.0);
          EXPECT_LE(depth, longest) << "angle " << angle << ", height " << height;
        }
      }
    }
  }
}

TEST(NormalProjectionDepth, OfAZeroNormalIsZero) {
  EXPECT_EQ(depth_at(Cylinder{}, kOrigin, {0, 0, 0.001}, Vec3::Zero()), 0.0);
}

/// Rounding error of a few operations on coordinates of up to 1 m [m].
constexpr double kRounding = 4e-15;

/// Depths [m] of a colliding point in one step, by three depth models.
struct Depths {
  double continuous = 0.0;
  double shortest = 0.0;
  double projected = 0.0;
};

/// A tool that moves through points, step by step.
class Stroke {
 public:
  explicit Stroke(const std::vector<SurfacePoint>& points,
                  std::shared_ptr<const ToolShape> tool = std::make_shared<Cylinder>())
      : tool_(std::move(tool)),
        shell_(points, 0.0),
        query_(make_contact_query(shell_, *tool_, Skips::off)),
        contacts_(query_->capacity()) {
    model_->prepare(shell_);
    model_->reset();
  }

  /// Moves the tool to the pose and returns the depths of the colliding points. The key is the index of the point.
  std::map<std::uint32_t, Depths> to(const ToolPose& pose) {
    query_->contacts_at(pose, contacts_);
    std::map<std::uint32_t, Depths> depths;
    std::vector<double> exits(contacts_.size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_.set_gradient(i, -contacts_.normal(i));
    tool_->shortest_depths(pose, contacts_);
    tool_->exit_distances(pose, contacts_, exits.data());
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      depths[contacts_.index[i]] = {0.0, contacts_.depth[i], exits[i]};
    }
    model_->evaluate(*tool_, pose, contacts_);
    for (std::size_t i = 0; i < contacts_.size(); ++i) depths[contacts_.index[i]].continuous = contacts_.depth[i];
    return depths;
  }

 private:
  std::shared_ptr<const ToolShape> tool_;
  PointShell shell_;
  std::unique_ptr<ContactQuery> query_;
  ContactBuffer contacts_;
  std::unique_ptr<DepthModel> model_ = make_depth_model("continuous_normal_projection");
};

ToolPose upright(double x, double z) {
  return {{x, 0.0, z}, {0.0, 0.0, -1.0}};
}

/// A random walk of a random tool among random points.
class RandomStroke {
 public:
  static constexpr double kMove = 1e-5, kTurn = 0.01;  ///< largest displacement [m] and rotation [rad] in a step

  explicit RandomStroke(std::uint64_t seed) : random_(seed) {}

  const ToolPose& next() {
    pose_.position += kMove * random_.uniform() * random_.direction();
    const Vec3 turn = kTurn * random_.uniform() * random_.direction();
    pose_.axis = (pose_.axis + turn.cross(pose_.axis)).normalized();
    return pose_;
  }
  std::vector<SurfacePoint> points() {
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 100; ++i) points.push_back({tool.near_point(pose_, random_), random_.direction()});
    return points;
  }

 private:
  Random random_;
  ToolPose pose_ = test::random_pose(random_);

 public:
  const test::DefinedTool tool = cylinders()[random_.below(2)].make(random_, 0.001);
};

TEST(ContinuousNormalProjectionDepth, FollowsItsFormulaFromStepToStep) {
  std::size_t at_the_smallest = 0, at_the_largest = 0, between = 0;
  for (std::uint64_t seed = 0; seed < test::cases(300); ++seed) {
    RandomStroke walk(seed);
    const std::vector<SurfacePoint> points = walk.points();
    Stroke stroke(points, walk.tool.shape);
    ToolPose before;
    std::map<std::uint32_t, Depths> last;
    for (int step = 0; step < 50; ++step) {
      const ToolPose pose = walk.next();
      const auto now = stroke.to(pose);
      for (const auto& [i, d] : now) {
        const Vec3 arm = points[i].position - pose.position;
        const Vec3 moved = pose.position - before.position + turn(before.axis, pose.axis).cross(arm);
        const double followed = last.contains(i) ? last[i].continuous - moved.dot(points[i].normal) : 0.0;
        const double expected = std::min(d.projected, std::max({0.0, d.shortest, followed}));
        ASSERT_NEAR(d.continuous, expected, kRounding) << seed << ' ' << step;
        at_the_smallest += d.continuous == d.shortest;
        at_the_largest += d.continuous == d.projected;
        between += d.continuous > d.shortest && d.continuous < d.projected;
      }
      last = now;
      before = pose;
    }
  }
  // Check that the walks reached both limits of `expected` and values between the limits.
  for (const std::size_t count : {at_the_smallest, at_the_largest, between}) EXPECT_GT(count, test::cases(300));
}

TEST(ContinuousNormalProjectionDepth, AFlatTipPressedInIsAsDeepAsItsTip) {
  // Press the tip in by up to twice the radius, where the shortest distance is at most the radius. The tolerance covers
  // the rounding of 1000 steps with lengths below 2 mm.
  Stroke stroke(surface_points(Plane{0.002, 0.0001}));
  for (int step = 0; step <= 1000; ++step) {
    const double depth = 1e-6 * step;
    for (const auto& [i, d] : stroke.to(upright(0.00001, -depth))) {
      ASSERT_EQ(d.projected, depth);
      ASSERT_NEAR(d.continuous, depth, 1e-15);
    }
  }
}

TEST(ContinuousNormalProjectionDepth, APointThatHasLeftIsForgotten) {
  Stroke stroke({{{0.0, 0.0, 0.0}, Vec3::UnitZ()}});
  for (int step = 0; step <= 700; ++step) stroke.to(upright(0.0, -1e-6 * step));
  EXPECT_NEAR(stroke.to(upright(0.0, -0.0007))[0].continuous, 0.0007, 1e-15);
  EXPECT_TRUE(stroke.to(upright(0.001, -0.0007)).empty());
  EXPECT_NEAR(stroke.to(upright(0.0004, -0.0007))[0].continuous, 0.0001, 1e-15);
}

}  // namespace
}  // namespace hapbench::depth_models_test
