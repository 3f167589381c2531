#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::depth_model_test {
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

class ShortestDistanceForTip : public testing::TestWithParam<Tip> {};
INSTANTIATE_TEST_SUITE_P(BothTips, ShortestDistanceForTip, testing::Values(Tip::flat, Tip::round),
                         [](const auto& tip) { return tip.param == Tip::flat ? "flat" : "round"; });

// Coordinates up to 1 m are subtracted and turned, with a few roundings of 1e-16 m each.
constexpr long double kTolerance = 1e-15L;

TEST_P(ShortestDistanceForTip, DepthIsTheDistanceToTheNearestSurface) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(100000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const Vec3 point = test::random_point_near(tool, pose, random);
    const long double inside = test::slack(tool, pose, point.cast<long double>());
    if (inside < kTolerance) continue;
    // Inside a convex body the distance to the surface is the slack of the nearest constraint.
    ASSERT_NEAR(static_cast<double>(evaluate(tool, pose, point).depth - inside), 0.0, static_cast<double>(kTolerance));
  }
}

TEST_P(ShortestDistanceForTip, GradientLeadsOutOfTheToolInExactlyTheDepth) {
  Random random(2);
  for (std::size_t i = 0; i < test::cases(100000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const Vec3 point = test::random_point_near(tool, pose, random);
    if (test::slack(tool, pose, point.cast<long double>()) < kTolerance) continue;
    const auto [depth, gradient] = evaluate(tool, pose, point);
    ASSERT_NEAR(gradient.norm(), 1.0, 4 * std::numeric_limits<double>::epsilon());
    // Only the shortest way out ends on the surface after that distance: any other direction stays inside. A radial
    // direction amplifies the rounding of the radial vector by r / |rho|, at most 1e6 for random points.
    const Vec3L way_out = point.cast<long double>() + depth * gradient.cast<long double>();
    ASSERT_NEAR(static_cast<double>(test::slack(tool, pose, way_out)), 0.0, 4e-15);
  }
}

// Dyadic sizes and a pose along the axes: every distance below is exact, so ties are real ties.
constexpr double kUnit = 0x1p-13;  // 0.12 mm
const Vec3 kAxis(0, 0, -1);
const ToolPose kPose{{0x1p-4, 0x1p-5, 0x1p-6}, kAxis};

/// The point s along the axis from the tip and a along +x, in units.
Vec3 at(double s, double a) {
  return kPose.position + kUnit * (s * kAxis + Vec3(a, 0, 0));
}

TEST(ShortestDistance, EachSurfaceOfTheFlatToolIsNearestToPointsBesideIt) {
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  const auto side = evaluate(tool, kPose, at(-8, 3));
  EXPECT_EQ(side.depth, kUnit);
  EXPECT_EQ(side.gradient, Vec3(1, 0, 0));
  const auto tip = evaluate(tool, kPose, at(-1, 1));
  EXPECT_EQ(tip.depth, kUnit);
  EXPECT_EQ(tip.gradient, kAxis);
  const auto bottom = evaluate(tool, kPose, at(-15, 1));
  EXPECT_EQ(bottom.depth, kUnit);
  EXPECT_EQ(bottom.gradient, Vec3(-kAxis));
}

TEST(ShortestDistance, TheRoundTipIsAHalfBallBeyondTheTipPlane) {
  const Cylinder tool{5 * kUnit, 16 * kUnit, Tip::round};
  // On the axis, one unit from the pole.
  const auto pole = evaluate(tool, kPose, at(4, 0));
  EXPECT_EQ(pole.depth, kUnit);
  EXPECT_EQ(pole.gradient, kAxis);
  // The tip plane is no surface: just behind it, the side is nearest and not the tip.
  const auto behind = evaluate(tool, kPose, at(-1, 4));
  EXPECT_EQ(behind.depth, kUnit);
  EXPECT_EQ(behind.gradient, Vec3(1, 0, 0));
  const auto bottom = evaluate(tool, kPose, at(-15, 1));
  EXPECT_EQ(bottom.depth, kUnit);
  EXPECT_EQ(bottom.gradient, Vec3(-kAxis));
}

TEST(ShortestDistance, TiesPreferTheSideThenTheTipThenTheBottom) {
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  EXPECT_EQ(evaluate(tool, kPose, at(-1, 3)).gradient, Vec3(1, 0, 0)) << "side and tip";
  EXPECT_EQ(evaluate(tool, kPose, at(-15, 3)).gradient, Vec3(1, 0, 0)) << "side and bottom";
  const Cylinder disc{4 * kUnit, 2 * kUnit, Tip::flat};
  EXPECT_EQ(evaluate(disc, kPose, at(-1, 1)).gradient, kAxis) << "tip and bottom";
  EXPECT_EQ(evaluate(disc, kPose, at(-1, 3)).gradient, Vec3(1, 0, 0)) << "all three";
  const Cylinder round{4 * kUnit, 16 * kUnit, Tip::round};
  EXPECT_EQ(evaluate(round, kPose, at(-15, 3)).gradient, Vec3(1, 0, 0)) << "side and bottom, round tip";
}

TEST(ShortestDistance, OnTheSurfaceTheDepthIsZeroAndTheGradientStillPointsOut) {
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  for (const auto& [s, a, gradient] :
       {std::tuple{-8.0, 4.0, Vec3(1, 0, 0)}, {0.0, 1.0, kAxis}, {-16.0, 1.0, Vec3(-kAxis)}}) {
    const auto contact = evaluate(tool, kPose, at(s, a));
    EXPECT_EQ(contact.depth, 0.0);
    EXPECT_EQ(contact.gradient, gradient);
  }
}

TEST(ShortestDistance, AnUndefinedDirectionFallsBackToTheInwardNormal) {
  const Vec3 normal = Vec3(3, 4, 0) / 5;
  // On the median line the side is nearest, in an undefined direction.
  const Cylinder flat{kUnit, 16 * kUnit, Tip::flat};
  const auto on_axis = evaluate(flat, kPose, at(-8, 0), normal);
  EXPECT_EQ(on_axis.depth, kUnit);
  EXPECT_EQ(on_axis.gradient, Vec3(-normal));
  // The same at the centre of the round tip, in the cylinder (s = 0) and just inside the ball.
  const Cylinder round{kUnit, 16 * kUnit, Tip::round};
  EXPECT_EQ(evaluate(round, kPose, at(0, 0), normal).gradient, Vec3(-normal));
  const ToolPose origin{Vec3::Zero(), kAxis};
  EXPECT_EQ(evaluate(round, origin, 1e-13 * kUnit * kAxis, normal).gradient, Vec3(-normal));
}

TEST(ShortestDistance, DirectionsLongerThan1e12thOfTheRadiusAreDefined) {
  const ToolPose origin{Vec3::Zero(), kAxis};
  const Vec3 normal = Vec3(3, 4, 0) / 5;
  for (const Tip tip : {Tip::flat, Tip::round}) {
    const Cylinder tool{kUnit, 16 * kUnit, tip};
    const Vec3 middle = 8 * kUnit * -kAxis;
    EXPECT_EQ(evaluate(tool, origin, middle + Vec3(1.01e-12 * kUnit, 0, 0), normal).gradient, Vec3(1, 0, 0));
    EXPECT_EQ(evaluate(tool, origin, middle + Vec3(0.99e-12 * kUnit, 0, 0), normal).gradient, Vec3(-normal));
  }
}

TEST(ShortestDistance, DepthsAloneLeaveGradientsUntouched) {
  ContactBuffer contacts(1);
  contacts.push(0, at(-8, 3), Vec3::UnitY());
  contacts.set_gradient(0, {7, 8, 9});
  Cylinder(4 * kUnit, 16 * kUnit, Tip::flat).shortest_depths(kPose, contacts);
  EXPECT_EQ(contacts.depth[0], kUnit);
  EXPECT_EQ(contacts.gradient(0), Vec3(7, 8, 9));
}

TEST(SurfaceNormal, HasTheDepthOfShortestDistanceAndTheInwardNormalAsGradient) {
  Random random(1);
  for (const Tip tip : {Tip::flat, Tip::round}) {
    const Cylinder tool = test::random_tool(random, tip);
    const ToolPose pose = test::random_pose(random);
    ContactBuffer contacts(1000);
    while (contacts.size() < contacts.capacity()) {
      const Vec3 point = test::random_point_near(tool, pose, random);
      if (test::slack(tool, pose, point.cast<long double>()) < 0.0L) continue;
      contacts.push(static_cast<std::uint32_t>(contacts.size()), point, random.direction());
    }
    ContactBuffer shortest = contacts;
    make_depth_model("surface_normal")->evaluate(tool, pose, contacts);
    make_depth_model("shortest_distance")->evaluate(tool, pose, shortest);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts.depth[i], shortest.depth[i]);
      EXPECT_EQ(contacts.gradient(i), Vec3(-contacts.normal(i)));
    }
  }
}

TEST(SurfaceNormal, DepthOnAFlatSaturatesAtTheToolsRadius) {
  // Thesis C.1: however far the tool is pressed through a plane, a point on its axis is r deep at most.
  const Cylinder tool;
  for (const double pressed : {0.0001, 0.0004, 0.002, 0.005}) {
    ContactBuffer contacts(1);
    contacts.push(0, Vec3::Zero(), Vec3::UnitZ());
    make_depth_model("surface_normal")->evaluate(tool, {{0, 0, -pressed}, {0, 0, -1}}, contacts);
    EXPECT_EQ(contacts.depth[0], std::min(pressed, tool.radius()));
  }
}

class EveryDepthModel : public testing::TestWithParam<DepthModelEntry> {};
INSTANTIATE_TEST_SUITE_P(Registered, EveryDepthModel, testing::ValuesIn(depth_models().begin(), depth_models().end()),
                         [](const auto& entry) { return std::string(entry.param.info->name); });

constexpr std::size_t kPoints = 100;

/// A new model, prepared as for a run.
std::unique_ptr<DepthModel> prepared(const DepthModelEntry& entry) {
  const PointShell shell(std::vector<SurfacePoint>(kPoints), 0.0);
  std::unique_ptr<DepthModel> model = entry.make();
  model->prepare(shell);
  return model;
}

/// The colliding points among random points in, near and on the tool, with depths of the model.
ContactBuffer contacts_of_random_scene(const DepthModelEntry& model, const Cylinder& tool, const ToolPose& pose,
                                       Random& random) {
  std::vector<SurfacePoint> points;
  while (points.size() < kPoints) {
    points.push_back({test::random_point_on(tool, pose, random), random.direction()});
    points.push_back({test::random_point_near(tool, pose, random), random.direction()});
  }
  const PointShell shell(points, 0.0);
  ShellQuery query(shell, tool);
  ContactBuffer contacts(query.capacity());
  query.contacts_at(pose, contacts);
  prepared(model)->evaluate(tool, pose, contacts);
  return contacts;
}

TEST_P(EveryDepthModel, NeverGivesACollidingPointANegativeDepth) {
  Random random(1);
  std::size_t on_surface = 0;
  for (std::size_t i = 0; i < test::cases(4000); ++i) {
    const Cylinder tool = test::random_tool(random, i % 2 == 0 ? Tip::flat : Tip::round);
    const ToolPose pose = test::random_pose(random);
    const ContactBuffer contacts = contacts_of_random_scene(GetParam(), tool, pose, random);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      ASSERT_GE(contacts.depth[k], 0.0);
      ASSERT_TRUE(std::isfinite(contacts.depth[k]));
      on_surface += contacts.depth[k] < 1e-15;
    }
  }
  // There were points that the search and the model could round differently.
  EXPECT_GT(on_surface, test::cases(4000));
}

TEST_P(EveryDepthModel, GradientsAreUnitVectors) {
  Random random(2);
  for (std::size_t i = 0; i < test::cases(1000); ++i) {
    const Cylinder tool = test::random_tool(random, i % 2 == 0 ? Tip::flat : Tip::round);
    const ContactBuffer contacts = contacts_of_random_scene(GetParam(), tool, test::random_pose(random), random);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      ASSERT_NEAR(contacts.gradient(k).norm(), 1.0, 4 * std::numeric_limits<double>::epsilon());
    }
  }
}

TEST_P(EveryDepthModel, PadsItsContacts) {
  Random random(3);
  const Cylinder tool;
  ContactBuffer contacts(8);
  for (int i = 0; i < 8; ++i) contacts.push(0, {0, 0, 0.001}, random.direction());
  contacts.shrink(5);
  prepared(GetParam())->evaluate(tool, {}, contacts);
  for (std::size_t i = 5; i < 8; ++i) {
    EXPECT_EQ(contacts.depth[i], 0.0);
    EXPECT_EQ(contacts.gradient(i), Vec3(0, 0, 0));
  }
}

TEST_P(EveryDepthModel, KeepsPointsNormalsAndIndices) {
  Random random(4);
  const Cylinder tool;
  const ToolPose pose = test::random_pose(random);
  const ContactBuffer contacts = contacts_of_random_scene(GetParam(), tool, pose, random);
  ContactBuffer again = contacts;
  prepared(GetParam())->evaluate(tool, pose, again);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    EXPECT_EQ(again.index[k], contacts.index[k]);
    EXPECT_EQ(again.point(k), contacts.point(k));
    EXPECT_EQ(again.normal(k), contacts.normal(k));
    EXPECT_EQ(again.depth[k], contacts.depth[k]);
    EXPECT_EQ(again.gradient(k), contacts.gradient(k));
  }
}

/// Depths of all contacts after the tool has gone through the poses, with `rests` steps without contacts before the
/// last pose.
AlignedDoubles depths_after(DepthModel& model, const Cylinder& tool, std::initializer_list<ToolPose> poses, int rests) {
  Random random(5);
  std::vector<SurfacePoint> points;
  while (points.size() < kPoints) points.push_back({test::random_point_near(tool, {}, random), random.direction()});
  const PointShell shell(points, 0.0);
  ShellQuery query(shell, tool);
  ContactBuffer contacts(query.capacity());
  for (const ToolPose& pose : poses) {
    if (&pose == poses.end() - 1) {
      contacts.clear();
      for (int i = 0; i < rests; ++i) model.evaluate(tool, {{1, 1, 1}, {0, 0, -1}}, contacts);
    }
    query.contacts_at(pose, contacts);
    model.evaluate(tool, pose, contacts);
  }
  EXPECT_GT(contacts.size(), 10u);
  AlignedDoubles depths = contacts.depth;
  depths.resize(contacts.size());
  return depths;
}

const ToolPose kHere, kThere{{0.0001, 0.0001, -0.0002}, Vec3(0.02, 0.03, -1.0).normalized()};

TEST_P(EveryDepthModel, IsAfterResetWhatItWasAtTheStart) {
  const Cylinder tool;
  const auto model = prepared(GetParam());
  const AlignedDoubles first = depths_after(*model, tool, {kHere, kThere}, 0);
  model->reset();
  EXPECT_EQ(depths_after(*model, tool, {kHere, kThere}, 0), first);
}

TEST_P(EveryDepthModel, LearnsNothingFromASecondStepWithoutContacts) {
  const Cylinder tool;
  const AlignedDoubles once = depths_after(*prepared(GetParam()), tool, {kHere, kThere}, 1);
  EXPECT_EQ(depths_after(*prepared(GetParam()), tool, {kHere, kThere}, 2), once);
  EXPECT_EQ(depths_after(*prepared(GetParam()), tool, {kHere, kThere}, 100), once);
}

/// Counts its calls, and those with contacts.
class CountingModel final : public DepthModel {
 public:
  struct Counts {
    int prepared = 0, reset = 0, evaluated = 0, with_contacts = 0;
  };
  explicit CountingModel(Counts& counts) : counts_(counts) {}

  void prepare(const PointShell&) override { ++counts_.prepared; }
  void reset() noexcept override { ++counts_.reset; }
  void evaluate(const ToolShape&, const ToolPose&, ContactBuffer& contacts) noexcept override {
    ++counts_.evaluated;
    counts_.with_contacts += !contacts.empty();
    contacts.pad();
  }

 private:
  Counts& counts_;
};

const Cylinder kTool;
const ToolPose kPressed{{0.00001, 0.00002, -0.0003}}, kFree{{0.0, 0.0, 1.0}};

class ShellSourceTest : public testing::Test {
 protected:
  ShellSource counting(Skips skips) {
    return {shell, kTool, std::make_unique<ShellQuery>(shell, kTool), std::make_unique<CountingModel>(counts), skips};
  }

  PointShell shell{surface_points(Plane{0.002, 0.0001}), 0.0};
  CountingModel::Counts counts;
};

TEST_F(ShellSourceTest, AnswersThePointsOfTheSearchWithTheDepthsOfTheModel) {
  for (const DepthModelEntry& entry : depth_models()) {
    ShellSource source(shell, kTool, std::make_unique<ShellQuery>(shell, kTool), entry.make());
    ShellQuery query(shell, kTool);
    const auto model = entry.make();
    model->prepare(shell);
    ContactBuffer answered(source.capacity()), expected(query.capacity());
    source.contacts_at(kPressed, answered);
    query.contacts_at(kPressed, expected);
    model->evaluate(kTool, kPressed, expected);
    ASSERT_EQ(answered.size(), expected.size());
    ASSERT_GT(answered.size(), 10u);
    for (std::size_t i = 0; i < answered.size(); ++i) {
      EXPECT_EQ(answered.index[i], expected.index[i]);
      EXPECT_EQ(answered.depth[i], expected.depth[i]);
      EXPECT_EQ(answered.gradient(i), expected.gradient(i));
    }
    EXPECT_EQ(source.work().queries, 1u);
  }
}

TEST_F(ShellSourceTest, TellsTheModelOnceThatThereIsNoContact) {
  for (const Skips skips : {Skips::on, Skips::off}) {
    counts = {};
    ShellSource source = counting(skips);
    EXPECT_EQ(counts.prepared, 1);
    ContactBuffer contacts(source.capacity());
    for (const ToolPose& pose : {kPressed, kFree, kFree, kFree, kPressed, kPressed, kFree}) {
      source.contacts_at(pose, contacts);
    }
    EXPECT_EQ(counts.with_contacts, 3);
    EXPECT_EQ(counts.evaluated, skips == Skips::on ? 5 : 7);
  }
}

TEST_F(ShellSourceTest, ForgetsInAResetThatThereWasNoContact) {
  ShellSource source = counting(Skips::on);
  ContactBuffer contacts(source.capacity());
  source.contacts_at(kFree, contacts);
  source.reset();
  EXPECT_EQ(counts.reset, 1);
  EXPECT_EQ(source.work().queries, 0u);
  source.contacts_at(kFree, contacts);
  EXPECT_EQ(counts.evaluated, 2);
}

}  // namespace
}  // namespace hapbench::depth_model_test
