#include "algorithms/depth/continuous_normal_projection_depth.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>

#include "algorithms/depth/normal_projection_depth.hpp"
#include "algorithms/depth/shortest_distance.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/tool_state.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::continuous_normal_projection_depth_test {
namespace {

/// Of coordinates up to 1 m, in a few operations [m].
constexpr double kRounding = 4e-15;

/// What is known of a colliding point in one step [m].
struct Depths {
  double continuous = 0.0;
  double shortest = 0.0;
  double projected = 0.0;
};

/// A tool led through points, step by step.
class Stroke {
 public:
  Stroke(const Cylinder& tool, const std::vector<SurfacePoint>& points)
      : tool_(tool), shell_(points, 0.0), query_(shell_, tool_), contacts_(query_.capacity()) {
    model_->prepare(shell_);
    model_->reset();
  }

  /// By index of the point.
  std::map<std::uint32_t, Depths> to(const ToolPose& pose) {
    query_.contacts_at(pose, contacts_);
    std::map<std::uint32_t, Depths> depths;
    std::vector<double> exits(contacts_.size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_.set_gradient(i, -contacts_.normal(i));
    tool_.shortest_depths(pose, contacts_);
    tool_.exit_distances(pose, contacts_, exits.data());
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      depths[contacts_.index[i]] = {0.0, contacts_.depth[i], exits[i]};
    }
    model_->evaluate(tool_, pose, contacts_);
    for (std::size_t i = 0; i < contacts_.size(); ++i) depths[contacts_.index[i]].continuous = contacts_.depth[i];
    return depths;
  }

 private:
  Cylinder tool_;
  PointShell shell_;
  ShellQuery query_;
  ContactBuffer contacts_;
  std::unique_ptr<DepthModel> model_ = make_continuous_normal_projection_depth();
};

ToolPose upright(double x, double z) {
  return {{x, 0.0, z}, {0.0, 0.0, -1.0}};
}

/// A random walk of a random tool among random points.
class RandomStroke {
 public:
  static constexpr double kMove = 1e-5, kTurn = 0.01;  ///< largest in a step [m, rad]

  explicit RandomStroke(std::uint64_t seed) : random_(seed) {}

  const ToolPose& next() {
    pose_.position += kMove * random_.uniform() * random_.direction();
    const Vec3 turn = kTurn * random_.uniform() * random_.direction();
    pose_.axis = (pose_.axis + turn.cross(pose_.axis)).normalized();
    return pose_;
  }
  std::vector<SurfacePoint> points() {
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 100; ++i)
      points.push_back({test::random_point_near(tool, pose_, random_), random_.direction()});
    return points;
  }

 private:
  Random random_;
  ToolPose pose_ = test::random_pose(random_);

 public:
  const Cylinder tool = test::random_tool(random_, random_.uniform() < 0.5 ? Tip::flat : Tip::round);
};

TEST(ContinuousNormalProjectionDepth, StartsAtTheShortestDistance) {
  for (std::uint64_t seed = 0; seed < test::cases(300); ++seed) {
    RandomStroke walk(seed);
    for (const auto& [i, d] : Stroke(walk.tool, walk.points()).to(walk.next())) {
      ASSERT_NEAR(d.continuous, std::max(0.0, d.shortest), kRounding);
    }
  }
}

TEST(ContinuousNormalProjectionDepth, IsBetweenShortestDistanceAndNormalProjection) {
  std::size_t at_the_least = 0, at_the_most = 0, between = 0;
  for (std::uint64_t seed = 0; seed < test::cases(300); ++seed) {
    RandomStroke walk(seed);
    Stroke stroke(walk.tool, walk.points());
    for (int step = 0; step < 50; ++step) {
      for (const auto& [i, d] : stroke.to(walk.next())) {
        ASSERT_GE(d.continuous, d.shortest - kRounding);
        ASSERT_LE(d.continuous, d.projected);
        at_the_least += d.continuous == d.shortest;
        at_the_most += d.continuous == d.projected;
        between += d.continuous > d.shortest && d.continuous < d.projected;
      }
    }
  }
  // Every case of the formula came up.
  for (const std::size_t count : {at_the_least, at_the_most, between}) EXPECT_GT(count, test::cases(300));
}

TEST(ContinuousNormalProjectionDepth, GrowsByNoMoreThanTheToolHasMovedAtThePoint) {
  double largest_jump_of_projection = 0.0;
  for (std::uint64_t seed = 0; seed < test::cases(300); ++seed) {
    RandomStroke walk(seed);
    const std::vector<SurfacePoint> points = walk.points();
    Stroke stroke(walk.tool, points);
    ToolPose before = walk.next();
    auto last = stroke.to(before);
    for (int step = 0; step < 50; ++step) {
      const ToolPose pose = walk.next();
      const Vec3 turned = turn(before.axis, pose.axis);
      const auto now = stroke.to(pose);
      for (const auto& [i, d] : now) {
        const Vec3 arm = points[i].position - pose.position;
        const double moved = (pose.position - before.position + turned.cross(arm)).norm();
        // dx is the way to first order in the turn; to second order a distance changes by |turn|^2 |arm| / 2 more.
        const double bound = moved + 0.5 * turned.squaredNorm() * arm.norm() + kRounding;
        const Depths was = last.contains(i) ? last[i] : Depths{};
        ASSERT_LE(d.continuous - was.continuous, bound);
        largest_jump_of_projection = std::max(largest_jump_of_projection, d.projected - was.projected);
      }
      last = now;
      before = pose;
    }
  }
  // Plain normal projection does not keep that: it jumps by more than the longest way of any step here, a turn of a
  // tool of 10 mm.
  EXPECT_GT(largest_jump_of_projection, RandomStroke::kMove + RandomStroke::kTurn * 0.012);
}

TEST(ContinuousNormalProjectionDepth, AFlatTipPressedInIsAsDeepAsItsTip) {
  // To twice the radius, where the shortest distance has long saturated. Every step adds a rounding of lengths < 2 mm.
  Stroke stroke(Cylinder{}, surface_points(Plane{0.002, 0.0001}));
  for (int step = 0; step <= 1000; ++step) {
    const double depth = 1e-6 * step;
    for (const auto& [i, d] : stroke.to(upright(0.00001, -depth))) {
      ASSERT_EQ(d.projected, depth);
      ASSERT_NEAR(d.continuous, depth, 1e-15);
    }
  }
}

TEST(ContinuousNormalProjectionDepth, ATippedOverToolPressedAcrossFollowsToWithinAStep) {
  // A tool that lies on the plane and goes down through it by 0.95 of its diameter. A point is found at most a step
  // after the surface has passed it; from then on its depth grows with the way.
  constexpr double kStep = 1e-6;
  const Cylinder tool;
  Stroke stroke(tool, surface_points(Plane{0.002, 0.00013}));
  double saturated = 0.0;
  for (int step = 0; step <= 950; ++step) {
    for (const auto& [i, d] : stroke.to({{0.005, 0.0, tool.radius() - kStep * step}, Vec3::UnitX()})) {
      ASSERT_LE(d.projected - d.continuous, kStep + 1e-15);
      saturated = std::max(saturated, d.continuous - d.shortest);
    }
  }
  // Beyond the median line: 0.95 of the diameter deep, a twentieth away from the other side.
  EXPECT_NEAR(saturated, 0.9 * 2.0 * tool.radius(), 2 * kStep);
}

TEST(ContinuousNormalProjectionDepth, UnderAFaceEnteredSidewaysItIsTheLargestShortestDistanceSoFar) {
  // Fig. F.4: an upright tool 1 mm below a face is led in under it.
  Stroke stroke(Cylinder{}, {{{0.0, 0.00003, 0.0}, Vec3::UnitZ()}});
  double largest = 0.0;
  int steps = 0;
  for (double x = -0.0006; x < 0.0004; x += 1e-6) {
    for (const auto& [i, d] : stroke.to(upright(x, -0.001))) {
      largest = std::max(largest, d.shortest);
      ASSERT_EQ(d.projected, 0.001);
      ASSERT_NEAR(d.continuous, largest, 1e-18);
      ++steps;
    }
  }
  EXPECT_GT(steps, 800);
  EXPECT_GT(largest, 0.0004);
}

TEST(ContinuousNormalProjectionDepth, APointThatHasLeftIsForgotten) {
  Stroke stroke(Cylinder{}, {{{0.0, 0.0, 0.0}, Vec3::UnitZ()}});
  for (int step = 0; step <= 700; ++step) stroke.to(upright(0.0, -1e-6 * step));
  EXPECT_NEAR(stroke.to(upright(0.0, -0.0007))[0].continuous, 0.0007, 1e-15);
  EXPECT_TRUE(stroke.to(upright(0.001, -0.0007)).empty());
  EXPECT_NEAR(stroke.to(upright(0.0004, -0.0007))[0].continuous, 0.0001, 1e-15);
}

TEST(ContinuousNormalProjectionDepth, PressingFromThereCountsOnTop) {
  // Entered from the side to 0.1 mm, then 0.3 mm down and up again: 0.1 mm more than the way, and back.
  Stroke stroke(Cylinder{}, {{{0.0, 0.0, 0.0}, Vec3::UnitZ()}});
  stroke.to(upright(0.001, -0.0007));
  stroke.to(upright(0.0004, -0.0007));
  EXPECT_NEAR(stroke.to(upright(0.0004, -0.0010))[0].continuous, 0.0004, 1e-15);
  EXPECT_NEAR(stroke.to(upright(0.0004, -0.0008))[0].continuous, 0.0002, 1e-15);
  EXPECT_NEAR(stroke.to(upright(0.0004, -0.0005))[0].continuous, 0.0001, 1e-15) << "not below the shortest distance";
  EXPECT_NEAR(stroke.to(upright(0.0004, -0.00005))[0].continuous, 0.00005, 1e-15) << "nor above the projection";
}

TEST(ContinuousNormalProjectionDepth, DoesNotCreepAtRest) {
  RandomStroke walk(1);
  Stroke stroke(walk.tool, walk.points());
  for (int step = 0; step < 50; ++step) stroke.to(walk.next());
  const ToolPose pose = walk.next();
  const auto first = stroke.to(pose);
  for (int step = 0; step < 1000; ++step) {
    for (const auto& [i, d] : stroke.to(pose)) ASSERT_EQ(d.continuous, first.at(i).continuous);
  }
}

}  // namespace
}  // namespace hapbench::continuous_normal_projection_depth_test
