#include "sim/tool/mesh_tool.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <string>

#include "sim/contact/contact_query.hpp"
#include "sim/core/random.hpp"
#include "sim/tool/signed_distance_grid.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/searches.hpp"

namespace hapbench::mesh_tool_test {
namespace {

using test::cases;
using test::exact_distance;
using test::grid_of;

struct NamedMesh {
  const char* name;
  TriangleSoup (*make)();
  double spacing;
  bool convex;
};
std::ostream& operator<<(std::ostream& out, const NamedMesh& mesh) {
  return out << mesh.name;
}

TriangleSoup off_centre_cube() {
  return test::cube(0.7, {0.1, 0.0, 0.4});
}
TriangleSoup two_cubes() {
  return test::together(test::cube(0.5), test::cube(0.3, {1.1, 0.2, 0.0}));
}

const NamedMesh kMeshes[] = {{"cube", off_centre_cube, 0.1, true},
                             {"sphere", [] { return test::sphere(1.0, 3); }, 0.15, true},
                             {"torus", [] { return test::torus(24, 12); }, 0.2, false},
                             {"cup", [] { return test::cup(20); }, 0.1, false},
                             {"two_cubes", two_cubes, 0.1, false},
                             {"cylinder", [] { return test::cylinder_mesh(0.5, 3.0, 32); }, 0.08, true}};

class GridOfMesh : public testing::TestWithParam<NamedMesh> {
 protected:
  const TriangleSoup soup_ = GetParam().make();
  const std::shared_ptr<const SignedDistanceGrid> grid_ = grid_of(soup_, GetParam().spacing);
};
INSTANTIATE_TEST_SUITE_P(OfAllKinds, GridOfMesh, testing::ValuesIn(kMeshes),
                         [](const auto& mesh) { return std::string(mesh.param.name); });

TEST_P(GridOfMesh, HasExactSignedDistancesAtItsNodes) {
  const GridNodes& nodes = grid_->nodes();
  Random random(1);
  for (std::size_t n = 0; n < cases(3000); ++n) {
    const std::size_t i = random.below(nodes.count[0]), j = random.below(nodes.count[1]),
                      k = random.below(nodes.count[2]);
    ASSERT_NEAR(grid_->values()[nodes.index(i, j, k)], exact_distance(soup_, nodes.position(i, j, k)), 1e-8)
        << nodes.position(i, j, k).transpose();
  }
}

TEST_P(GridOfMesh, KnowsWhetherItIsConvex) {
  EXPECT_EQ(grid_->convex(), GetParam().convex);
}

TEST_P(GridOfMesh, MarksNodesAsAllInsideOrOutsideOnlyIfTheirNeighboursAre) {
  const GridNodes& nodes = grid_->nodes();
  std::size_t kinds[3] = {};
  for (std::size_t i = 1; i + 1 < nodes.count[0]; ++i) {
    for (std::size_t j = 1; j + 1 < nodes.count[1]; ++j) {
      for (std::size_t k = 1; k + 1 < nodes.count[2]; ++k) {
        const std::uint8_t kind = grid_->kinds()[nodes.index(i, j, k)];
        ++kinds[kind];
        for (std::size_t n = 0; n < 27; ++n) {
          const double value = grid_->values()[nodes.index(i + n / 9 - 1, j + n / 3 % 3 - 1, k + n % 3 - 1)];
          ASSERT_TRUE(kind == SignedDistanceGrid::mixed || (kind == SignedDistanceGrid::inside) == (value <= 0.0));
        }
      }
    }
  }
  for (const std::size_t count : kinds) EXPECT_GT(count, 0u);
}

TEST_P(GridOfMesh, IsTheSameBytesForAnyNumberOfThreads) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto again = grid_of(soup_, GetParam().spacing);
  const std::size_t n = grid_->nodes().size();
  EXPECT_TRUE(std::equal(grid_->values(), grid_->values() + n, again->values()));
  EXPECT_TRUE(std::equal(grid_->kinds(), grid_->kinds() + n, again->kinds()));
}

TEST_P(GridOfMesh, KnowsTheForemostPointInEveryDirection) {
  Random random(2);
  for (std::size_t n = 0; n < cases(3000); ++n) {
    const Vec3 u = n % 4 == 0 ? Vec3(Vec3::Unit(static_cast<int>(n / 4 % 3))) : random.direction();
    double largest = -1e300;
    for (const Vec3& v : soup_.vertices) largest = std::max(largest, u.dot(v));
    ASSERT_NEAR(grid_->hull().support(u), largest, 1e-14);
    ASSERT_NEAR(grid_->hull().foremost(u, 2.0 * random.direction()).dot(u), largest, 1e-8);
  }
}

TEST(SignedDistanceGrid, FindsAPointOfAForemostEdgeOrFaceAcrossTheDirection) {
  const auto grid = grid_of(test::cube(1.0), 0.1);
  EXPECT_LT((grid->hull().foremost({0, 0, 1}, {0.3, -0.2, 4.0}) - Vec3(0.3, -0.2, 1.0)).norm(),
            0.001);  // tolerance [m]: the support point is found in two passes over the corners
  EXPECT_LT((grid->hull().foremost(Vec3(0, 1, 1).normalized(), {0.3, 3.0, 4.0}) - Vec3(0.3, 1, 1)).norm(), 1e-9);
}

TEST(SignedDistanceGrid, SuggestsSome128NodesAlongAnEdge) {
  for (const Vec3& extent : {Vec3(1, 1, 1), Vec3(0.001, 0.001, 0.01), Vec3(2, 1, 0.4)}) {
    TriangleSoup box = test::cube(0.5);
    for (Vec3& v : box.vertices) v = v.cwiseProduct(extent);
    const auto grid = grid_of(box, SignedDistanceGrid::suggested_spacing(box.vertices));
    EXPECT_GT(grid->nodes().size(), 1u << 20);
    EXPECT_LT(grid->nodes().size(), 1u << 22);
  }
}

/// Returns the message of the error for a mesh; empty if the mesh is accepted.
std::string refusal(const TriangleSoup& soup, double spacing = 0.1) {
  try {
    grid_of(soup, spacing);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(SignedDistanceGrid, RefusesBadMeshesWithWhatWasMeasured) {
  EXPECT_EQ(refusal(test::cube()), "");
  TriangleSoup open = test::cube();
  open.triangles.pop_back();
  EXPECT_EQ(refusal(open),
            "the mesh bounds no solid: 3 boundary edges (edges with only one triangle); the first at [1, -1, 0] m; "
            "close its holes");
  TriangleSoup turned = test::cube();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_NE(refusal(turned).find("3 edges whose triangles have inconsistent winding"), std::string::npos);
  EXPECT_NE(refusal(test::reversed(test::cube())).find("inside out (volume -8 m^3)"), std::string::npos);
  EXPECT_EQ(refusal(TriangleSoup{}), "the mesh has no triangles");
  TriangleSoup flat = test::cube();
  for (Vec3& v : flat.vertices) v.z() = 0.0;
  EXPECT_NE(refusal(flat).find("encloses no volume"), std::string::npos) << refusal(flat);
  TriangleSoup infinite = test::cube();
  infinite.vertices[3].y() = INFINITY;
  EXPECT_EQ(refusal(infinite), "vertex 3 of the mesh is not finite");
  TriangleSoup stray = test::cube();
  stray.triangles[0][0] = 8;
  EXPECT_NE(refusal(stray), "");
  for (const double spacing : {0.0, -1.0, std::nan("")}) {
    EXPECT_NE(refusal(test::cube(), spacing).find("spacing of a grid must be > 0"), std::string::npos);
  }
}

TEST(SignedDistanceGrid, RefusesMeshesThatPassThroughThemselves) {
  const std::string overlap = refusal(test::together(test::cube(), test::cube(1.0, {0.5, 0.5, 0.5})));
  EXPECT_NE(overlap.find("the mesh intersects itself: it encloses ["), std::string::npos) << overlap;
  EXPECT_NE(overlap.find("2 times, and so "), std::string::npos) << overlap;
  const std::string hollow = refusal(test::together(test::cube(), test::reversed(test::cube(0.5, {3, 0, 0}))));
  EXPECT_NE(hollow.find("-1 times"), std::string::npos) << hollow;
  // A cavity is no self-intersection, so the mesh is accepted.
  EXPECT_EQ(refusal(test::together(test::cube(), test::reversed(test::cube(0.5)))), "");
}

TEST(SignedDistanceGrid, RefusesMeshesThatAreThinnerThanTheirGridOrTooLarge) {
  const std::string thin = refusal(test::cup(20), 0.2);
  EXPECT_NE(thin.find("of its surface is less than two spacings (0.4 m) thick; the smallest thickness is 0.29"),
            std::string::npos)
      << thin;
  EXPECT_NE(thin.find("set the nodes at most 0.14"), std::string::npos) << thin;
  const std::string large = refusal(test::scaled(test::cube(), 1000.0));
  EXPECT_NE(large.find("is its scale right? If so, set the nodes "), std::string::npos) << large;
  EXPECT_NE(refusal(test::cube(), 1e-300), "");
}

const ToolPose kHome;

ToolPose random_pose(Random& random) {
  return {random.direction(), random.direction(), random.uniform(-3.0, 3.0)};
}

Vec3 to_world(const ToolPose& pose, const Vec3& x) {
  return pose.position + pose.rotation() * x;
}

Vec3 random_position(const SignedDistanceGrid& grid, Random& random, double beyond = 0.2) {
  const Vec3 extent = grid.box().size();
  return grid.box().min - beyond * extent +
         (1.0 + 2.0 * beyond) * extent.cwiseProduct(Vec3(random.uniform(), random.uniform(), random.uniform()));
}

ContactBuffer contacts_at(const std::vector<Vec3>& points) {
  ContactBuffer contacts(points.size());
  for (const Vec3& point : points) contacts.push(0, point, {0, 0, 1});
  contacts.pad();
  return contacts;
}

/// Returns phi_h, the signed distance field on the grid, at a point in the world frame [m].
double field(const MeshTool& tool, const ToolPose& pose, const Vec3& point) {
  ContactBuffer contacts = contacts_at({point});
  tool.shortest_depths(pose, contacts);
  return -contacts.depth[0];
}

Vec3 gradient(const MeshTool& tool, const ToolPose& pose, const Vec3& point) {
  ContactBuffer contacts = contacts_at({point});
  tool.shortest_gradients(pose, contacts);
  return contacts.gradient(0);
}

bool near(const MeshTool& tool, const ToolPose& pose, double margin, const Vec3& point) {
  const ContactBuffer at = contacts_at({point});
  const PackRange one{0, 1, 1, 1};
  std::uint8_t marks = 0;
  tool.mark_near(pose, margin, {at.x.data(), at.y.data(), at.z.data()}, {&one, 1}, &marks);
  return marks == 1;
}

class MeshToolOf : public testing::TestWithParam<NamedMesh> {
 protected:
  const TriangleSoup soup_ = GetParam().make();
  const MeshTool tool_{grid_of(soup_, GetParam().spacing)};
  const SignedDistanceGrid& grid_ = tool_.grid();
};
INSTANTIATE_TEST_SUITE_P(OfAllKinds, MeshToolOf, testing::ValuesIn(kMeshes),
                         [](const auto& mesh) { return std::string(mesh.param.name); });

TEST_P(MeshToolOf, IsWithinItsBoundOfTheExactDistance) {
  Random random(1);
  double worst = 0.0;
  for (std::size_t i = 0; i < cases(5000); ++i) {
    const Vec3 x = random_position(grid_, random, 0.0);
    const double exact = exact_distance(soup_, x);
    const double error = field(tool_, kHome, x) - exact;
    worst = std::max(worst, std::abs(error));
    ASSERT_LE(std::abs(error), grid_.error_bound()) << x.transpose();
    // By Jensen's inequality, the error of a convex tool is not negative, up to the rounding of distances that are
    // computed by other operations.
    ASSERT_TRUE(!tool_.convex() || error >= -1e-12) << error;
  }
  // The bound is not too large: the largest error, at edges and in the middle of walls, is more than a sixth of the
  // bound.
  EXPECT_GT(worst, grid_.error_bound() / 6.0);
}

TEST_P(MeshToolOf, FindsInEverySearchTheContactsOfBruteForceAndGivesThemDepths) {
  Random random(2);
  std::uint64_t contacts = 0, rebuilt = 0, poses = 0;
  const std::size_t shells = cases(400);
  for (std::size_t s = 0; s < shells; ++s) {
    const double size = grid_.reach() * std::pow(10.0, random.uniform(-0.7, 1.0));
    const PointShell shell(test::random_shell(random, size),
                           random.below(2) == 0 ? 0.0 : size * random.uniform(0.01, 1.0));
    const auto brute = make_contact_query(shell, tool_, Skips::off);
    const auto by_list = make_contact_query(shell, tool_, Skips::on);
    ContactBuffer all(brute->capacity()), of_list(by_list->capacity());
    ToolPose pose{Vec3::Zero(), random.direction()};
    for (int k = 0; k < 500; ++k, ++poses) {
      pose = test::next_pose(pose, random, size, 0.2 * grid_.half_width());
      if (random.below(3) == 0) pose.roll += 0.03 * random.uniform(-1.0, 1.0);
      brute->contacts_at(pose, all);
      by_list->contacts_at(pose, of_list);
      ASSERT_LE(all.size(), by_list->capacity());
      ASSERT_TRUE(test::same_contacts(all, of_list)) << "shell " << s << ", pose " << k;
      contacts += all.size();
      if (k % 50 != 0) continue;
      // The sign of the field decides whether a point is in contact, to the last bit.
      ContactBuffer points(shell.size());
      for (std::size_t i = 0; i < shell.size(); ++i) {
        points.push(static_cast<std::uint32_t>(i), shell.point(i).position, shell.point(i).normal);
      }
      tool_.shortest_depths(pose, points);
      std::size_t next = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(next < all.size() && all.index[next] == i, points.depth[i] >= 0.0) << points.depth[i];
        next += points.depth[i] >= 0.0;
      }
    }
    rebuilt += by_list->work().lists_rebuilt;
  }
  // Check that the tools touch points on their random walks, and that neighbour lists are used more than once.
  EXPECT_GT(contacts, poses);
  EXPECT_LT(rebuilt, poses / 2);
}

TEST_P(MeshToolOf, MarksAsNearWhateverLiesWithinTheMargin) {
  Random random(3);
  std::size_t outside = 0, positions = 0;
  while (positions < cases(5000)) {
    const ToolPose pose = random_pose(random);
    const Vec3 inside = random_position(grid_, random, 0.0);
    if (field(tool_, kHome, inside) > 0.0) continue;
    ++positions;
    const double margin = 2.0 * tool_.half_width() * random.uniform();
    const Vec3 point = to_world(pose, inside + margin * random.direction());
    outside += field(tool_, pose, point) > 0.0;
    const double rounding = 1e-12;
    ASSERT_TRUE(near(tool_, pose, margin + rounding, point));
    const Box everywhere{Vec3::Constant(-20.0), Vec3::Constant(20.0)}, here{point, point};
    for (const Box& bounds : {everywhere, here}) {
      const Box box = tool_.box_near(pose, margin + rounding, bounds);
      ASSERT_TRUE((point.array() >= box.min.array()).all() && (point.array() <= box.max.array()).all());
    }
    const ToolShape::Grown grown = tool_.grown(margin + rounding);
    const PointShell shell({{point, Vec3::UnitZ()}}, 0.0);
    const auto query = make_contact_query(shell, *grown.shape, Skips::off);
    ContactBuffer found(1);
    query->contacts_at({pose.position + grown.forward * pose.axis, pose.axis, pose.roll}, found);
    ASSERT_EQ(found.size(), 1u);
  }
  EXPECT_GT(outside, cases(5000) / 10);
  EXPECT_FALSE(near(tool_, kHome, 0.1, {0.0, 0.0, 100.0}));
  const Box far{Vec3::Constant(100.0), Vec3::Constant(101.0)};
  const Box none = tool_.box_near(kHome, 0.1, far);
  EXPECT_TRUE((none.min.array() > none.max.array()).any());
}

TEST_P(MeshToolOf, MovesNoPointOfItsBodyFurtherThanItSays) {
  Random random(4);
  for (std::size_t i = 0; i < cases(5000); ++i) {
    const ToolPose from = random_pose(random);
    const double turn = std::pow(10.0, random.uniform(-6.0, 0.0));
    const ToolPose to{from.position + turn * random.direction(), (from.axis + turn * random.direction()).normalized(),
                      from.roll + turn * random.uniform(-1.0, 1.0)};
    Vec3 x = random_position(grid_, random, 0.0);
    if (x.norm() > tool_.reach()) x *= tool_.reach() / x.norm();
    ASSERT_LE((to_world(to, x) - to_world(from, x)).norm(), tool_.displacement_bound(from, to) + 1e-14);
  }
  EXPECT_EQ(tool_.displacement_bound(kHome, kHome), 0.0);
  EXPECT_FALSE(tool_.is_axisymmetric());
}

TEST_P(MeshToolOf, HasTheGradientOfItsField) {
  Random random(5);
  const double step = 1e-6 * GetParam().spacing;
  for (std::size_t i = 0; i < cases(2000); ++i) {
    const ToolPose pose = random_pose(random);
    const Vec3 x = to_world(pose, random_position(grid_, random, 0.0));
    Vec3 slope;
    for (int k = 0; k < 3; ++k) {
      slope[k] =
          (field(tool_, pose, x + step * Vec3::Unit(k)) - field(tool_, pose, x - step * Vec3::Unit(k))) / (2.0 * step);
    }
    const Vec3 u = gradient(tool_, pose, x);
    ASSERT_NEAR(u.norm(), 1.0, 1e-14);
    // The difference quotient has a rounding error of 1e-16 / step, and a truncation error of the order of the step.
    // The error of its direction is the sum of both errors, divided by the gradient's length.
    ASSERT_TRUE(slope.norm() < 0.1 || (slope.normalized() - u).norm() < 1e-6);
    // Continuity: in the grid, the second derivatives of the field are at most 2 / spacing, so a displacement by a
    // thousandth of a spacing changes the field's gradient by at most 0.006. If this gradient has at least the length
    // 0.5, its direction u then changes by less than 0.02. Shorter gradients are not checked.
    const Vec3 beside = gradient(tool_, pose, x + 1e-3 * GetParam().spacing * random.direction());
    ASSERT_TRUE(slope.norm() < 0.5 || (beside - u).norm() < 0.02);
  }
}

TEST_P(MeshToolOf, LeavesItsBodyAtTheExitDistance) {
  Random random(6);
  std::size_t found = 0;
  while (found < cases(2000)) {
    const ToolPose pose = random_pose(random);
    const Vec3 x = to_world(pose, random_position(grid_, random, 0.0));
    if (field(tool_, pose, x) > 0.0) continue;
    ++found;
    ContactBuffer contacts = contacts_at({x});
    const Vec3 u = random.direction();
    contacts.set_gradient(0, u);
    double exit = -1.0;
    tool_.exit_distances(pose, contacts, &exit);
    ASSERT_GE(exit, 0.0);
    ASSERT_NEAR(field(tool_, pose, x + exit * u), 0.0, 1e-9);
    // Every position on the ray before the exit is inside, except in gaps of the tool that are shorter along the ray
    // than the smallest step of the search.
    for (double t = 0.0; t < exit - GetParam().spacing / 8.0; t += GetParam().spacing / 4.0) {
      ASSERT_LE(field(tool_, pose, x + t * u), 0.0) << t << " of " << exit;
    }
    // At the exit, the exit distance along the field's gradient is finite and at most twice the reach of the tool.
    ContactBuffer there = contacts_at({x + exit * u});
    there.set_gradient(0, gradient(tool_, pose, x + exit * u));
    tool_.exit_distances(pose, there, &exit);
    ASSERT_GE(exit, 0.0);
    ASSERT_LE(exit, 2.0 * tool_.reach());
  }
}

TEST_P(MeshToolOf, SurvivesPosesAndDirectionsThatAreNotFinite) {
  const PointShell shell({{{0, 0, 0.5}, {0, 0, 1}}}, 0.1);
  const auto brute = make_contact_query(shell, tool_, Skips::off);
  const auto list = make_contact_query(shell, tool_, Skips::on);
  ContactBuffer found(8);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), inf, -inf, 1e300}) {
    for (const ToolPose& pose : {ToolPose{{bad, 0, 0}, {0, 0, -1}}, ToolPose{{0, 0, 0}, {0, bad, -1}}}) {
      list->contacts_at(pose, found);
      EXPECT_EQ(found.size(), 0u);
      brute->contacts_at(pose, found);
      EXPECT_EQ(found.size(), 0u);
    }
  }
  ContactBuffer contacts = contacts_at({grid_.box().min, 0.5 * (grid_.box().min + grid_.box().max)});
  for (const Vec3& u : {Vec3(0, 0, 0), Vec3(std::nan(""), 0, 0)}) {
    for (std::size_t i = 0; i < 2; ++i) contacts.set_gradient(i, u);
    double exits[2];
    tool_.exit_distances(kHome, contacts, exits);
    for (const double exit : exits) EXPECT_TRUE(exit >= 0.0 && exit <= 4.0 * tool_.reach()) << exit;
  }
}

TEST_P(MeshToolOf, KeepsPointsOutOfConvexBodiesByItsConstraints) {
  if (!tool_.convex()) return;
  Random random(8);
  for (std::size_t i = 0; i < cases(5000); ++i) {
    const ToolPose pose = random_pose(random);
    const Vec3 x = to_world(pose, random_position(grid_, random));
    ContactBuffer contacts(1);
    contacts.push(0, x, random.direction());
    const Vec3 wanted = tool_.half_width() * random.direction();
    tool_.surface_constraints(pose, wanted, 0.0, contacts);
    const double depth = contacts.depth[0];
    const Vec3 m = contacts.gradient(0);
    // A move that exactly satisfies the constraint keeps the point out.
    Vec3 move = tool_.half_width() * random.direction();
    move -= (depth + m.dot(move)) * m;
    const ToolPose moved{pose.position + move, pose.axis, pose.roll};
    ASSERT_GE(field(tool_, moved, x), -1e-12) << depth;
    // The point is not farther away than the constraint states.
    ASSERT_LE(-depth, field(tool_, pose, x) + 1e-12);
  }
}

}  // namespace
}  // namespace hapbench::mesh_tool_test
