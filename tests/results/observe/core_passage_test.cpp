#include "results/observe/inside_observer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "results/observe/inside_observer.hpp"
#include "sim/geometry/solid.hpp"
#include "sim/tool/bur_profile.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "sim/tool/revolved.hpp"
#include "tests/results/observing.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

/// Tests walls thinner than the tool, through which the tool passes on different paths, and deep positions where the
/// tool does not pass through.
namespace hapbench::core_passage_test {
namespace {

constexpr double kRadius = 0.0005;

struct NamedTool {
  const char* name;
  std::shared_ptr<const ToolShape> shape;
};

std::vector<NamedTool> tools() {
  const auto bur = [](BurFamily family, double shank) {
    const double length = family == BurFamily::ball ? 2.0 * kRadius : 0.003;
    auto [profile, tip] = bur_profile(family, 2.0 * kRadius, length, shank * 2.0 * kRadius);
    return std::make_shared<const Revolved>(std::move(profile), tip);
  };
  const TriangleSoup drill = test::cylinder_mesh(kRadius, 0.008, 32);
  return {{"flat drill", std::make_shared<const Cylinder>(kRadius, 0.008)},
          {"round drill", std::make_shared<const Cylinder>(kRadius, 0.008, Tip::round)},
          {"ball on a thin neck", bur(BurFamily::ball, 0.3)},
          {"inverted cone", bur(BurFamily::inverted_cone, 0.5)},
          {"flame", bur(BurFamily::flame, 0.6)},
          {"mesh", std::make_shared<const MeshTool>(test::grid_of(drill, 0.1 * kRadius))}};
}

/// Returns a box between two corners [m].
TriangleSoup box(const Vec3& low, const Vec3& high) {
  TriangleSoup soup = test::cube(0.5, Vec3::Constant(0.5));
  for (Vec3& v : soup.vertices) v = low + v.cwiseProduct(high - low);
  return soup;
}

/// Returns points near y = 0 on the faces of a box that are perpendicular to x or z, with a spacing of a fifth of the
/// tool's radius.
std::vector<Vec3> points_of(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> points;
  const double spacing = 0.2 * kRadius;
  for (double y = -0.0003; y <= 0.00031; y += spacing) {
    for (double x = low.x(); x <= high.x(); x += spacing)
      for (const double z : {low.z(), high.z()}) points.push_back({x, y, z});
    for (double z = low.z(); z <= high.z(); z += spacing)
      for (const double x : {low.x(), high.x()}) points.push_back({x, y, z});
  }
  return points;
}

using Path = std::function<ToolPose(double u)>;  ///< path of the tool, u = 0 … 1
ToolPose upright(double x, double z) {
  return {{x, 0.0, z}, {0.0, 0.0, -1.0}, 0.0};
}

struct Ran {
  bool through;    ///< true if any part of the tool has passed through
  double deepest;  ///< depth of the deepest contact [m]
};

/// Moves the tool along its path in `rows` steps, with contacts at the points. Returns whether any part of the tool has
/// passed through the solid, and the depth of the deepest contact [m].
Ran run(const NamedTool& tool, const std::shared_ptr<const Solid>& solid, const std::vector<Vec3>& points,
        const Path& path, int rows) {
  InsideObserver observer(tool.shape, solid);
  ContactBuffer contacts(points.size());
  for (const Vec3& p : points) contacts.push(0, p, Vec3::UnitZ());
  double deepest = 0.0;
  for (int i = 0; i <= rows; ++i) {
    StepRecord row = test::row(static_cast<std::uint64_t>(i), 0.001 * i, contacts);
    row.tool.pose = path(static_cast<double>(i) / rows);
    tool.shape->surface_constraints(row.tool.pose, Vec3::Zero(), 0.0, contacts);
    row.force.depth_max = std::max(0.0, contacts.largest_depth());
    deepest = std::max(deepest, row.force.depth_max);
    observer.on_step(row);
  }
  return {observer.passage().went_through() || observer.core_passage().event().has_value(), deepest};
}

/// Paths through a plate of the thickness t [m]. The plate extends from x = 0 to x = 4 mm, below z = 0.
struct NamedPath {
  const char* name;
  int rows;
  std::function<Path(double t)> path;
};

Path sideways(double t) {
  return [t](double u) { return upright(-0.0015 + 0.007 * u, -t - 3.0 * kRadius); };
}

const NamedPath kPaths[] = {
    {"pushed", 200, [](double t) { return [t](double u) { return upright(0.002, 0.001 - u * (t + 0.003)); }; }},
    {"pushed and withdrawn", 200,
     [](double t) {
       return [t](double u) { return upright(0.002, 0.001 - (1.0 - std::abs(2.0 * u - 1.0)) * (t + 0.0015)); };
     }},
    {"led sideways", 300, sideways},
    {"led in leaps", 12, sideways},
    {"turned", 200,
     [](double t) {
       return [t](double u) {
         return ToolPose{{-0.0008, 0.0, -t - 0.0008}, {-std::sin(1.4 * u), 0.0, -std::cos(1.4 * u)}, 0.0};
       };
     }},
};

class ThroughAPlate : public testing::TestWithParam<std::size_t> {};

/// Checks plates with a thickness from a twentieth of the tool's radius to three radii.
TEST_P(ThroughAPlate, OnEveryPath) {
  const NamedTool tool = tools()[GetParam()];
  constexpr double kShares[] = {0.05, 0.1, 0.3, 0.6, 1.0, 1.8, 3.0};
  for (std::size_t i = 0; i < std::size(kShares); i += test::sanitized(3)) {
    const double share = kShares[i], t = share * kRadius;
    const Vec3 low(0.0, -0.003, -t), high(0.004, 0.003, 0.0);
    const TriangleSoup plate = box(low, high);
    const std::shared_ptr<const Solid> solid = make_solid(plate.vertices, plate.triangles);
    const std::vector<Vec3> points = points_of(low, high);
    for (const NamedPath& w : kPaths)
      EXPECT_TRUE(run(tool, solid, points, w.path(t), w.rows).through) << tool.name << " " << share << " " << w.name;
  }
}
INSTANTIATE_TEST_SUITE_P(Tools, ThroughAPlate, testing::Range<std::size_t>(0, 6));

/// Checks a wall that stands on the ground. The tool enters by one face and leaves by the opposite face, but at no time
/// does its core (the part of the tool's axis within the body) reach from face to face.
TEST(ThroughAWall, FromOneFaceToTheOther) {
  for (const double share : {0.05, 0.3, 1.0, 1.8}) {
    const Vec3 low(0.0, -0.003, -0.02), high(share * kRadius, 0.003, 0.0);
    const TriangleSoup wall = box(low, high);
    const std::shared_ptr<const Solid> solid = make_solid(wall.vertices, wall.triangles);
    const std::vector<Vec3> points = points_of({0.0, -0.003, -0.004}, high);
    for (const NamedTool& tool : tools()) {
      const Path path = [](double u) { return upright(-0.0015 + 0.004 * u, -0.002); };
      EXPECT_TRUE(run(tool, solid, points, path, 200).through) << tool.name << " " << share;
      const Path back = [&path](double u) { return path(0.45 * (1.0 - std::abs(2.0 * u - 1.0))); };
      // On the path `back`, the axis of the tool moves 0.3 mm into the wall and returns. If the wall is thicker, this
      // is no passage.
      if (share >= 1.0) {
        EXPECT_FALSE(run(tool, solid, points, back, 200).through) << tool.name << " " << share;
      }
    }
  }
}

/// Checks that three paths into a block and out again do not count as a passage through the block: the tool is pressed
/// onto the top and lifted; it is pressed into the side and drawn back; it is pressed into the side and drawn out
/// upwards. Also checks that a path through the block does not count if the triangles of the block face inwards.
TEST(DeepInABlock, IsNotThrough) {
  const Vec3 low(0.0, -0.003, -0.004), high(0.004, 0.003, 0.0);
  const TriangleSoup block = box(low, high);
  const std::shared_ptr<const Solid> solid = make_solid(block.vertices, block.triangles);
  const TriangleSoup turned = test::reversed(block);
  const std::shared_ptr<const Solid> inside_out = make_solid(turned.vertices, turned.triangles);
  const std::vector<Vec3> points = points_of(low, high);
  const auto there_and_back = [](double u) { return 1.0 - std::abs(2.0 * u - 1.0); };
  for (const NamedTool& tool : tools()) {
    const double back = core_offset(*tool.shape);
    const Path pressed = [&](double u) { return upright(0.002, 0.001 - there_and_back(u) * (0.001 + 0.95 * back)); };
    const Path beside = [&](double u) { return upright(-0.001 + 0.0013 * there_and_back(u), -0.002); };
    const Path out_above = [&](double u) {
      return upright(-0.001 + 0.0013 * std::min(1.0, 2.0 * u), -0.002 + 0.004 * std::max(0.0, 2.0 * u - 1.0));
    };
    for (const auto& [name, path] : {std::pair("pressed", &pressed), {"beside", &beside}, {"out above", &out_above}}) {
      const Ran ran = run(tool, solid, points, *path, 200);
      EXPECT_FALSE(ran.through) << tool.name << " " << name;
      EXPECT_GE(ran.deepest, 0.25 * kRadius) << tool.name << " " << name;
    }
    const Path through = [](double u) { return upright(0.002, 0.001 - 0.008 * u); };
    EXPECT_FALSE(run(tool, inside_out, points, through, 200).through) << tool.name;
  }
}

/// Checks the drill in a hole, pressed against the wall, the rim and the bottom, almost as deep as the drill is wide.
TEST(DeepInAHole, IsNotThrough) {
  const std::shared_ptr<const Solid> hole = make_solid(BlockWithHole{{0.006, 0.006, 0.004}, 0.00104, 0.002});
  std::vector<Vec3> points;
  for (int i = 0; i < 32; ++i)
    for (int k = 0; k <= 20; ++k)
      points.push_back({0.00052 * std::cos(0.1963 * i), 0.00052 * std::sin(0.1963 * i), -0.0001 * k});
  for (double x = -0.0004; x < 0.0005; x += 0.0001) points.push_back({x, 0.0, -0.002});
  const NamedTool drill = tools()[0];
  const Path worked = [](double u) {
    const double aside = 0.00048 * std::sin(12.0 * u), tilt = 0.1 * std::sin(7.0 * u);
    return ToolPose{
        {aside, 0.0, 0.0006 - 0.00305 * std::sin(3.14159 * u)}, {std::sin(tilt), 0.0, -std::cos(tilt)}, 0.0};
  };
  const Ran ran = run(drill, hole, points, worked, 400);
  EXPECT_FALSE(ran.through);
  EXPECT_GE(ran.deepest, 0.85 * kRadius);
}

}  // namespace
}  // namespace hapbench::core_passage_test
