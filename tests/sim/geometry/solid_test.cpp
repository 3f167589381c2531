#include <gtest/gtest.h>

#include <cmath>

#include "sim/contact/inside.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/solid.hpp"
#include "sim/tool/bur_profile.hpp"
#include "sim/tool/revolved.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::solid_test {
namespace {

Vec3 random_point(Random& random, double half) {
  return half * Vec3(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
}

std::unique_ptr<const Solid> solid_of(const TriangleSoup& soup) {
  return make_solid(soup.vertices, soup.triangles);
}

TEST(Solid, BelowAPlaneIsTheDepthAtAnyDepth) {
  const auto plane = make_solid(Plane{0.01, 0.0001});
  for (const double z : {1.0, 1e-6, -1e-6, -0.5}) {
    EXPECT_EQ(plane->at({0.004, -0.004, z}).value, z);
    EXPECT_TRUE(plane->at({0.004, -0.004, z}).known);
    EXPECT_FALSE(plane->at({0.006, 0.0, z}).known) << "beside the square";
  }
}

/// Compares the distance of the solid with the smallest distance to dense points on its surface. The distance to the
/// points is too large by at most half a diagonal of the squares between the points.
template <class Shape>
void expect_distances_to_points(Shape shape, double reach, bool planar) {
  const auto solid = make_solid(shape);
  const std::vector<SurfacePoint> points = surface_points(shape);
  Random random(3);
  int inside = 0;
  for (int i = 0; i < 300; ++i) {
    Vec3 q = random_point(random, reach);
    if (planar) q.z() = 0.0;
    const SurfaceDistance phi = solid->at(q);
    if (!phi.known) continue;
    double nearest = 1e9;
    const SurfacePoint* point = nullptr;
    for (const SurfacePoint& p : points) {
      if ((p.position - q).norm() >= nearest) continue;
      nearest = (p.position - q).norm();
      point = &p;
    }
    EXPECT_LE(std::abs(phi.value), nearest + 1e-12);
    EXPECT_GE(std::abs(phi.value), nearest - 0.75 * shape.spacing) << q.transpose();
    // Away from the surface, the normal of the nearest point gives the sign, even if it is the mean normal of two faces
    // at an edge.
    if (nearest > 2.0 * shape.spacing) {
      EXPECT_EQ(phi.value > 0.0, point->normal.dot(q - point->position) > 0.0) << q.transpose();
    }
    inside += phi.value < 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, 20);
}

TEST(Solid, OfAnalyticScenesHasTheDistanceToTheirPoints) {
  expect_distances_to_points(Slot{0.001, 0.005, 0.01, 0.0001}, 0.004, false);
  expect_distances_to_points(Hole2d{0.001, 0.005, 0.00005, 0.004}, 0.004, true);
  expect_distances_to_points(ConicalHole{0.5, 0.003, 0.00004}, 0.0016, false);
}

Vec3 test_gradient(const TriangleSoup& soup, const Vec3& q) {
  constexpr double kStep = 1e-8;
  Vec3 gradient;
  for (int k = 0; k < 3; ++k) {
    const Vec3 aside = kStep * Vec3::Unit(k);
    gradient[k] = test::exact_distance(soup, q + aside) - test::exact_distance(soup, q - aside);
  }
  return gradient.normalized();
}

TEST(Solid, OfAClosedMeshHasItsExactDistance) {
  const TriangleSoup box = test::cube(0.005, {0.001, 0.0, 0.0}), cup = test::scaled(test::cup(24), 0.003);
  for (const TriangleSoup* soup : {&box, &cup}) {
    const auto solid = solid_of(*soup);
    Random random(4);
    for (int i = 0; i < 300; ++i) {
      const Vec3 q = random_point(random, 0.01);
      EXPECT_NEAR(solid->at(q).value, test::exact_distance(*soup, q), 1e-12) << q.transpose();
      const KnownDistance near{q + random_point(random, 0.002), 0.0};
      const KnownDistance looked{near.point, solid->at(near.point).value};
      EXPECT_EQ(solid->at(q, &looked).value, solid->at(q).value);
      EXPECT_NEAR(solid->gradient(q, 1e-6).dot(test_gradient(*soup, q)), 1.0, 1e-6) << q.transpose();
      EXPECT_TRUE(solid->at(q).known);
    }
    // The solid counts the winding number along a vertical line through the query point. If this line goes along edges
    // or through vertices, the sign must still be right.
    EXPECT_NEAR(solid->at(soup->vertices[0] - Vec3(0, 0, 1)).value,
                test::exact_distance(*soup, soup->vertices[0] - Vec3(0, 0, 1)), 1e-12);
  }
  EXPECT_NEAR(solid_of(test::cube())->at({0, 0, 0}).value, -1.0, 1e-15);
}

TEST(Solid, OfPartsThatOverlapIsInsideInBoth) {
  const auto solid = solid_of(test::together(test::cube(1.0), test::cube(1.0, {0.7, 0.0, 0.0})));
  for (double x = -0.95; x < 1.7; x += 0.05) EXPECT_LT(solid->at({x, 0.1, 0.2}).value, 0.0) << x;
  EXPECT_GT(solid->at({1.75, 0.1, 0.2}).value, 0.0);
}

TEST(Solid, OfAnOpenSheetIsUnknownBeyondItsBorder) {
  const auto solid = solid_of(test::sheet(10, 10, [](int i, int j) { return Vec3(0.001 * i, 0.001 * j, 0.0); }));
  const double up = solid->at({0.005, 0.005, 0.001}).value;  // the winding of the sheet determines the sign
  EXPECT_NEAR(std::abs(up), 0.001, 1e-15);
  for (const double z : {0.02, -0.02}) {
    EXPECT_NEAR(solid->at({0.0052, 0.0047, z}).value, std::copysign(1.0, up) * z, 1e-15);
    EXPECT_TRUE(solid->at({0.0052, 0.0047, z}).known);
    EXPECT_FALSE(solid->at({0.0102, 0.005, z}).known);
    EXPECT_FALSE(solid->at({-0.001, -0.002, z}).known);
  }
}

TEST(Solid, OfPointsIsThatOfTheirPlanesAndUnknownBeyondThem) {
  std::vector<SurfacePoint> points;
  Random random(5);
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const Vec3 shift = random_point(random, 0.00003);
      points.push_back({{0.0001 * i + shift.x(), 0.0001 * j + shift.y(), 0.0}, Vec3::UnitZ()});
    }
  }
  const auto solid = make_solid(points);
  for (const double z : {0.003, 0.00001, -0.00001, -0.02}) {
    for (double x = 0.0002; x < 0.0037; x += 0.00013) {
      EXPECT_NEAR(solid->at({x, 0.002, z}).value, z, 1e-15);
      EXPECT_TRUE(solid->at({x, 0.002, z}).known);
    }
    EXPECT_FALSE(solid->at({0.0045, 0.002, z}).known) << z;
    EXPECT_FALSE(solid->at({0.01, -0.01, z}).known) << z;
  }
}

constexpr double kRadius = 0.0005;

Revolved ball() {
  const BurProfile profile = bur_profile(BurFamily::ball, 2.0 * kRadius, 2.0 * kRadius, 0.6 * kRadius);
  return Revolved(profile.profile, profile.tip);
}

ToolPose at(const Vec3& position) {
  ToolPose pose;
  pose.position = position;
  return pose;
}

TEST(Inside, OfABallInAPlaneIsItsDepthAtAnyDepth) {
  const Revolved tool = ball();
  const auto plane = make_solid(Plane{0.01, 0.0001});
  InsideSearch search(tool, *plane);
  for (const double h : {-0.001, 0.0, 1e-7, 2.5e-5, 0.0004, 0.0009, 0.0021, 0.02}) {
    const auto depth = search.depth(at({0.0012, -0.0007, kRadius - h}));
    ASSERT_TRUE(depth);
    EXPECT_NEAR(*depth, std::max(0.0, h), 1e-12);
  }
  EXPECT_FALSE(search.depth(at({0.006, 0.0, -0.002}))) << "beyond the border, nobody knows";
  EXPECT_NEAR(search.depth(at({0.0052, 0.0, -0.002})).value_or(0.0), 0.002 + std::sqrt(kRadius * kRadius - 4e-8), 2e-5)
      << "the part within the border";
}

TEST(Inside, OfAToolOverABorderIsNeverNothing) {
  const Revolved tool = ball();
  const TriangleSoup soup = test::sheet(8, 8, [](int i, int j) { return Vec3(0.0005 * i, 0.0005 * j, 0.0); });
  auto sheet = make_solid(soup.vertices, soup.triangles);
  const double up = sheet->at({0.002, 0.002, 0.001}).value > 0.0 ? 1.0 : -1.0;
  InsideSearch search(tool, *sheet);
  ToolPose pose = at({0.002, 0.002, up * (kRadius - 0.0001)});
  pose.axis = {0.0, 0.0, -up};
  EXPECT_NEAR(search.depth(pose).value_or(0.0), 0.0001, 1e-12);
  pose.position = {0.006, 0.002, -up * 0.003};
  EXPECT_FALSE(search.depth(pose));
  pose.position = {0.002, 0.002, up * 0.003};
  EXPECT_EQ(search.depth(pose).value_or(1.0), 0.0);
}

/// Returns the depth below the solid's surface of the deepest grid node that lies in the tool.
double dense_depth(const test::DefinedTool& tool, const ToolPose& pose, const Solid& solid, double step) {
  const Box box = tool.shape->box_near(pose, 0.0, solid.region());
  const Vec3 low = box.min.cwiseMax(solid.region().min), high = box.max.cwiseMin(solid.region().max);
  double deepest = 0.0;
  for (double x = low.x(); x <= high.x(); x += step) {
    for (double y = low.y(); y <= high.y(); y += step) {
      for (double z = low.z(); z <= high.z(); z += step) {
        const Vec3 q(x, y, z);
        const SurfaceDistance phi = solid.at(q);
        if (!phi.known || -phi.value <= deepest) continue;
        if (tool.slack(pose, q.cast<long double>()) >= 0.0) deepest = -phi.value;
      }
    }
  }
  return deepest;
}

struct TiltedSolid {
  const char* name;
  std::unique_ptr<const Solid> solid;
  double tilt;
};

/// Compares the depth of tools of every kind in solids of every kind with the depth of the deepest sample. The samples
/// are the nodes of a dense grid that lie in the tool. The deepest sample may be deeper than the result of the search
/// by at most the tolerance of the search.
TEST(Inside, AgreesWithADenseSampleOfTheTool) {
  const TriangleSoup box = test::cube(0.001, {0.0, 0.0, -0.001});
  const TriangleSoup plate = test::cube(0.001, {0.0, 0.0, 0.0});
  TriangleSoup thin = plate;
  for (Vec3& v : thin.vertices) v = {3.0 * v.x(), 3.0 * v.y(), 0.1 * v.z() - 0.0001};
  std::vector<TiltedSolid> solids;
  solids.push_back({"plane", make_solid(Plane{0.01, 0.0001}), 0.0});
  solids.push_back({"plane, leaning", make_solid(Plane{0.01, 0.0001}), 0.7});
  solids.push_back({"block", make_solid(BlockWithHole{{0.006, 0.006, 0.004}, 0.0008, 0.001}), 0.4});
  solids.push_back({"cone", make_solid(ConicalHole{0.5, 0.001, 0.0001}), 0.2});
  solids.push_back({"slot", make_solid(Slot{0.0006, 0.002, 0.004, 0.0001}), 0.1});
  solids.push_back({"cube", make_solid(box.vertices, box.triangles), 0.3});
  solids.push_back({"plate", make_solid(thin.vertices, thin.triangles), 0.5});
  Random random(7);
  int deep = 0;
  double largest = 0.0;
  for (const test::ToolKind& kind : test::tool_kinds()) {
    for (const TiltedSolid& tilted : solids) {
      const test::DefinedTool tool = kind.make(random, 0.001);
      const double width = tool.shape->half_width();
      ToolPose pose;
      pose.position = {0.0006 * random.uniform(), 0.0006 * random.uniform(), width * (1.2 - 3.0 * random.uniform())};
      const double tilt = tilted.tilt * random.uniform();
      pose.axis = {-std::sin(tilt), 0.0, -std::cos(tilt)};
      InsideSearch search(*tool.shape, *tilted.solid);
      const auto depth = search.depth(pose);
      const double step = std::max(0.00002, 0.05 * width), sample = dense_depth(tool, pose, *tilted.solid, step);
      if (!depth) {
        EXPECT_EQ(sample, 0.0) << kind.name << " in " << tilted.name;
        continue;
      }
      EXPECT_LE(sample, *depth + InsideSearch::kTolerance * (width + *depth)) << kind.name << " in " << tilted.name;
      // Usually, a sample is within half a diagonal of the grid from the deepest point of the tool. At sharp edges of
      // the tool, the nearest sample may be farther away, so two diagonals are allowed.
      EXPECT_LE(*depth, sample + 2.0 * std::sqrt(3.0) * step) << kind.name << " in " << tilted.name;
      largest = std::max(largest, sample - *depth);
      deep += *depth > 0.0 ? 1 : 0;
      // A bound that is computed at this pose must not be lower than the depth. The same is true for a bound that is
      // computed at the nearby pose `beside` for all poses that are as near to `beside` as this pose.
      InsideBound bound(*tool.shape, *tilted.solid);
      EXPECT_GE(std::max(0.0, bound.at(pose, 0.0, 0.0, 0.0, true)), *depth - 1e-12)
          << kind.name << " in " << tilted.name;
      EXPECT_GE(std::max(0.0, bound.at(pose, 0.0, 0.0, 0.0, false)), *depth - 1e-12)
          << kind.name << " in " << tilted.name;
      ToolPose beside = pose;
      beside.position += Vec3(0.0001 * random.uniform(), 0.0, 0.0002 * random.uniform());
      beside.axis = Vec3(-std::sin(tilt + 0.05), 0.0, -std::cos(tilt + 0.05));
      const double moved = (beside.position - pose.position).norm(), turned = (beside.axis - pose.axis).norm();
      EXPECT_GE(std::max(0.0, bound.at(beside, moved, turned, 0.0, true)), *depth - 1e-12)
          << kind.name << " in " << tilted.name;
      EXPECT_GE(std::max(0.0, bound.coarse_bound_at(beside, moved, turned)), *depth - 1e-12)
          << kind.name << " in " << tilted.name;
      // A known depth shortens the search but does not change the result.
      EXPECT_EQ(search.depth(pose, *depth).value_or(-1.0), *depth) << kind.name << " in " << tilted.name;
    }
  }
  EXPECT_GT(deep, 20);
  RecordProperty("largest_shortfall_um", std::to_string(1e6 * largest));
}

/// Checks how much the bound exceeds the depth. The bound comes from balls that contain a part of the tool. The ball of
/// a round tip is larger than the tip only by a tenth of the tolerance, for rounding. A tilted flat tip touches a large
/// ball whose centre is behind the tip along the surface's normal. The bound is less tight there, because the radii of
/// successive candidate balls differ by up to a factor of two.
TEST(Inside, HasATightBoundOverAMesh) {
  const TriangleSoup cube = test::cube(0.004, {0.0, 0.0, -0.004});
  const auto solid = make_solid(cube.vertices, cube.triangles);
  const Revolved round = ball();
  const Cylinder flat(kRadius, 0.01, Tip::flat);
  for (const double tilt : {0.0, 0.1, 0.3, 0.6}) {
    ToolPose pose = at({0.0003, 0.0002, kRadius - 0.0001});
    pose.axis = {-std::sin(tilt), 0.0, -std::cos(tilt)};
    EXPECT_NEAR(InsideBound(round, *solid).at(pose, 0.0, 0.0, 0.0, true), 0.0001, 2e-3 * kRadius) << tilt;
    pose.position.z() = kRadius * std::sin(tilt) - 0.0001;
    EXPECT_NEAR(InsideBound(flat, *solid).at(pose, 0.0, 0.0, 0.0, true), 0.0001, 0.1 * kRadius) << tilt;
  }
}

TEST(Inside, OfAMeshToolIsThatOfItsMesh) {
  const auto grid = test::grid_of(test::cylinder_mesh(0.0005, 0.002, 48), 0.00003);
  const MeshTool tool(grid);
  const auto plane = make_solid(Plane{0.01, 0.0001});
  InsideSearch search(tool, *plane);
  for (const double tilt : {0.0, 0.3}) {
    ToolPose pose = at({0.0, 0.0, -0.0001});
    pose.axis = {-std::sin(tilt), 0.0, -std::cos(tilt)};
    // The deepest point is the lowest corner of the mesh. One of the 48 corners of its end lies exactly in the
    // direction of the tilt.
    EXPECT_NEAR(search.depth(pose).value_or(0.0), 0.0001 + 0.0005 * std::sin(tilt), grid->error_bound()) << tilt;
  }
}

/// Checks that the known distance of a nearby point, which bounds the search for the distance of a point, changes no
/// bit of the result. Some points are on the surface.
TEST(Solid, KnownDistanceNearbyChangesNothing) {
  const TriangleSoup sphere = test::sphere(0.004, 3);
  TriangleSoup open = sphere;
  open.triangles.resize(open.triangles.size() / 2);
  std::vector<SurfacePoint> points;
  for (const Vec3& v : sphere.vertices) points.push_back({v, v.normalized()});
  std::vector<std::unique_ptr<const Solid>> solids;
  solids.push_back(solid_of(sphere));
  solids.push_back(solid_of(open));
  solids.push_back(make_solid(points));
  solids.push_back(make_solid(BlockWithHole{}));
  Random random(5);
  for (const auto& solid : solids) {
    for (int i = 0; i < 2000; ++i) {
      const Vec3 near = i % 4 == 0 ? sphere.vertices[static_cast<std::size_t>(i) % sphere.vertices.size()]
                                   : random_point(random, 0.006);
      const Vec3 q = i % 3 == 0 ? near : Vec3(near + random_point(random, i % 2 == 0 ? 1e-5 : 0.003));
      const KnownDistance known{near, solid->at(near).value};
      const SurfaceDistance alone = solid->at(q), helped = solid->at(q, &known);
      EXPECT_EQ(alone.value, helped.value);
      EXPECT_EQ(alone.known, helped.known);
      EXPECT_EQ(solid->gradient(q, 1e-6), solid->gradient(q, 1e-6, &known));
    }
  }
}

}  // namespace
}  // namespace hapbench::solid_test
