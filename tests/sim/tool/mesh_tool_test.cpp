#include "sim/tool/mesh_tool.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/contact/neighbour_list_query.hpp"
#include "sim/tool/cylinder.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_meshes.hpp"

namespace hapbench::mesh_tool_test {
namespace {

using test::cases;
using test::exact_distance;
using test::grid_of;

const ToolPose kHome;

ToolPose random_pose(Random& random) {
  return {random.direction(), random.direction(), random.uniform(-3.0, 3.0)};
}

Vec3 to_world(const ToolPose& pose, const Vec3& x) {
  return pose.position + pose.rotation() * x;
}

Vec3 random_place(const SignedDistanceGrid& grid, Random& random, double beyond = 0.2) {
  const Vec3 extent = grid.high() - grid.low();
  return grid.low() - beyond * extent +
         (1.0 + 2.0 * beyond) * extent.cwiseProduct(Vec3(random.uniform(), random.uniform(), random.uniform()));
}

ContactBuffer contacts_at(const std::vector<Vec3>& points) {
  ContactBuffer contacts(points.size());
  for (const Vec3& point : points) contacts.push(0, point, {0, 0, 1});
  contacts.pad();
  return contacts;
}

/// phi_h at a point of the world.
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

struct NamedMesh {
  const char* name;
  TriangleSoup (*make)();
  double spacing;
};
std::ostream& operator<<(std::ostream& out, const NamedMesh& mesh) {
  return out << mesh.name;
}

const NamedMesh kMeshes[] = {{"cube",
                              [] {
                                return test::cube(0.7, {0.1, 0.0, 0.4});
                              },
                              0.1},
                             {"sphere", [] { return test::sphere(1.0, 3); }, 0.15},
                             {"torus", [] { return test::torus(24, 12); }, 0.2},
                             {"cup", [] { return test::cup(20); }, 0.1},
                             {"cylinder", [] { return test::cylinder_mesh(0.5, 3.0, 32); }, 0.08}};

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
    const Vec3 x = random_place(grid_, random, 0.0);
    const double exact = exact_distance(soup_, x);
    const double error = field(tool_, kHome, x) - exact;
    worst = std::max(worst, std::abs(error));
    ASSERT_LE(std::abs(error), grid_.error_bound()) << x.transpose();
    // By Jensen's inequality, up to the rounding of distances that are found by different arithmetic.
    ASSERT_TRUE(!tool_.convex() || error >= -1e-12) << error;
  }
  // The bound is no guess: edges and middles of walls come within a factor of three of it.
  EXPECT_GT(worst, grid_.error_bound() / 6.0);
}

TEST_P(MeshToolOf, FindsInEverySearchTheContactsOfBruteForceAtAMillionPosesAndGivesThemDepths) {
  Random random(2);
  std::uint64_t contacts = 0, rebuilt = 0, poses = 0;
  const std::size_t shells = cases(400);
  for (std::size_t s = 0; s < shells; ++s) {
    const double size = grid_.reach() * std::pow(10.0, random.uniform(-0.7, 1.0));
    const PointShell shell(test::random_shell(random, size),
                           random.below(2) == 0 ? 0.0 : size * random.uniform(0.01, 1.0));
    ShellQuery brute(shell, tool_);
    GridQuery by_grid(shell, tool_);
    NeighbourListQuery by_list(shell, tool_);
    ContactBuffer all(brute.capacity()), of_grid(by_grid.capacity()), of_list(by_list.capacity());
    ToolPose pose{Vec3::Zero(), random.direction()};
    for (int k = 0; k < 500; ++k, ++poses) {
      pose = test::next_pose(pose, random, size, 0.2 * grid_.half_width());
      if (random.below(3) == 0) pose.roll += 0.03 * random.uniform(-1.0, 1.0);
      brute.contacts_at(pose, all);
      by_grid.contacts_at(pose, of_grid);
      by_list.contacts_at(pose, of_list);
      ASSERT_LE(all.size(), by_list.capacity());
      ASSERT_TRUE(test::same_contacts(all, of_grid)) << "shell " << s << ", pose " << k;
      ASSERT_TRUE(test::same_contacts(all, of_list)) << "shell " << s << ", pose " << k;
      contacts += all.size();
      if (k % 50 != 0) continue;
      // The field's sign is what decides, to the bit.
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
    rebuilt += by_list.work().lists_rebuilt;
  }
  // The walks touch something, and the lists are used more than once.
  EXPECT_GT(contacts, poses);
  EXPECT_LT(rebuilt, poses / 2);
}

TEST_P(MeshToolOf, MarksAsNearWhateverLiesWithinTheMargin) {
  Random random(3);
  std::size_t outside = 0, places = 0;
  while (places < cases(5000)) {
    const ToolPose pose = random_pose(random);
    const Vec3 inside = random_place(grid_, random, 0.0);
    if (field(tool_, kHome, inside) > 0.0) continue;
    ++places;
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
    const ContactBuffer at = contacts_at({point});
    const PackRange one{0, 1, 1, 1};
    std::uint8_t marks = 0;
    grown.shape->mark_inside({pose.position + grown.forward * pose.axis, pose.axis, pose.roll},
                             {at.x.data(), at.y.data(), at.z.data()}, {&one, 1}, &marks);
    ASSERT_EQ(marks, 1);
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
    Vec3 x = random_place(grid_, random, 0.0);
    if (x.norm() > tool_.reach()) x *= tool_.reach() / x.norm();
    ASSERT_LE((to_world(to, x) - to_world(from, x)).norm(), tool_.moved_at_most(from, to) + 1e-14);
  }
  EXPECT_EQ(tool_.moved_at_most(kHome, kHome), 0.0);
}

TEST_P(MeshToolOf, HasTheGradientOfItsField) {
  Random random(5);
  const double step = 1e-6 * GetParam().spacing;
  for (std::size_t i = 0; i < cases(2000); ++i) {
    const ToolPose pose = random_pose(random);
    const Vec3 x = to_world(pose, random_place(grid_, random, 0.0));
    Vec3 slope;
    for (int k = 0; k < 3; ++k) {
      slope[k] =
          (field(tool_, pose, x + step * Vec3::Unit(k)) - field(tool_, pose, x - step * Vec3::Unit(k))) / (2.0 * step);
    }
    const Vec3 u = gradient(tool_, pose, x);
    ASSERT_NEAR(u.norm(), 1.0, 1e-14);
    // The error of the difference, 1e-16 / step and the step itself, over the gradient's length.
    ASSERT_TRUE(slope.norm() < 0.1 || (slope.normalized() - u).norm() < 1e-6);
    // Continuous: a thousandth of a spacing turns it by no more than a few of those over its length.
    const Vec3 beside = gradient(tool_, pose, x + 1e-3 * GetParam().spacing * random.direction());
    ASSERT_TRUE(slope.norm() < 0.5 || (beside - u).norm() < 0.02);
  }
}

TEST_P(MeshToolOf, LeavesItsBodyAtTheExitDistance) {
  Random random(6);
  std::size_t found = 0;
  while (found < cases(2000)) {
    const ToolPose pose = random_pose(random);
    const Vec3 x = to_world(pose, random_place(grid_, random, 0.0));
    if (field(tool_, pose, x) > 0.0) continue;
    ++found;
    ContactBuffer contacts = contacts_at({x});
    const Vec3 u = random.direction();
    contacts.set_gradient(0, u);
    double exit = -1.0;
    tool_.exit_distances(pose, contacts, &exit);
    ASSERT_GE(exit, 0.0);
    ASSERT_NEAR(field(tool_, pose, x + exit * u), 0.0, 1e-9);
    // Every place before is inside, but for holes below the shortest way.
    for (double t = 0.0; t < exit - GetParam().spacing / 8.0; t += GetParam().spacing / 4.0) {
      ASSERT_LE(field(tool_, pose, x + t * u), 0.0) << t << " of " << exit;
    }
    // From there the surface is at hand.
    ContactBuffer there = contacts_at({x + exit * u});
    there.set_gradient(0, gradient(tool_, pose, x + exit * u));
    tool_.exit_distances(pose, there, &exit);
    ASSERT_GE(exit, 0.0);
    ASSERT_LE(exit, 2.0 * tool_.reach());
  }
}

TEST_P(MeshToolOf, DoesNotDependOnWhereAndHowLargeItIs) {
  Random random(7);
  const TriangleSoup half = test::scaled(soup_, 0.5);
  const MeshTool small(grid_of(half, 0.5 * GetParam().spacing));
  for (std::size_t i = 0; i < cases(2000); ++i) {
    const ToolPose pose = random_pose(random);
    const Vec3 x = random_place(grid_, random);
    // Positions of some metres, in a field that changes no faster than sqrt(3).
    ASSERT_NEAR(field(tool_, pose, to_world(pose, x)), field(tool_, kHome, x), 1e-13);
    // Powers of two change no bit.
    ASSERT_EQ(field(small, kHome, 0.5 * x), 0.5 * field(tool_, kHome, x));
  }
}

TEST_P(MeshToolOf, SurvivesPosesAndDirectionsThatAreNotFinite) {
  const PointShell shell(test::sphere(0.5, 2).vertices.empty() ? std::vector<SurfacePoint>{}
                                                               : std::vector<SurfacePoint>{{{0, 0, 0.5}, {0, 0, 1}}},
                         0.1);
  ShellQuery brute(shell, tool_);
  NeighbourListQuery list(shell, tool_);
  ContactBuffer found(8);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), inf, -inf, 1e300}) {
    for (const ToolPose& pose : {ToolPose{{bad, 0, 0}, {0, 0, -1}}, ToolPose{{0, 0, 0}, {0, bad, -1}}}) {
      list.contacts_at(pose, found);
      EXPECT_EQ(found.size(), 0u);
      brute.contacts_at(pose, found);
      EXPECT_EQ(found.size(), 0u);
    }
  }
  ContactBuffer contacts = contacts_at({grid_.low(), 0.5 * (grid_.low() + grid_.high())});
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
    const Vec3 x = to_world(pose, random_place(grid_, random));
    ContactBuffer contacts(1);
    contacts.push(0, x, random.direction());
    const Vec3 wanted = tool_.half_width() * random.direction();
    tool_.surface_constraints(pose, wanted, 0.0, contacts);
    const double depth = contacts.depth[0];
    const Vec3 m = contacts.gradient(0);
    // A move that only just keeps the constraint keeps the point out.
    Vec3 move = tool_.half_width() * random.direction();
    move -= (depth + m.dot(move)) * m;
    const ToolPose moved{pose.position + move, pose.axis, pose.roll};
    ASSERT_GE(field(tool_, moved, x), -1e-12) << depth;
    // And it is no further away than it seems.
    ASSERT_LE(-depth, field(tool_, pose, x) + 1e-12);
  }
}

TEST(MeshTool, EqualsTheCylinderOfItsMeshUpToChordsAndRoundedEdges) {
  const int sides = 128;
  const double radius = 0.0005, length = 0.01, spacing = 0.00002;
  const MeshTool tool(grid_of(test::cylinder_mesh(radius, length, sides), spacing));
  const Cylinder cylinder(radius, length, Tip::flat);
  Random random(9);
  const double chord = radius * (1.0 - std::cos(3.14159265358979 / sides));
  for (std::size_t i = 0; i < cases(5000); ++i) {
    const ToolPose pose = random_pose(random);
    const Vec3 x = random_place(tool.grid(), random, 0.0);
    const double rho = x.head<2>().norm();
    if (rho > radius || x.z() < 0.0 || x.z() > length) continue;
    ContactBuffer a = contacts_at({to_world(pose, x)}), b = a;
    tool.shortest_depths(pose, a);
    cylinder.shortest_depths(pose, b);
    // Where the nearest place changes from side to end, edges are rounded within the bound; elsewhere by curvature.
    const double to_side = radius - rho, to_end = std::min(x.z(), length - x.z());
    const bool smooth = std::abs(to_side - to_end) > 4.0 * spacing && rho > 4.0 * spacing;
    // The largest curvature of the distance in the stencil is that at its innermost node.
    const double curved = to_side < to_end && smooth ? spacing * spacing / 8.0 / (rho - 3.0 * spacing) : 0.0;
    ASSERT_LE(std::abs(a.depth[0] - b.depth[0]), smooth ? chord + curved + 1e-15 : tool.grid().error_bound() + chord);
  }
  EXPECT_NEAR(tool.half_width(), cylinder.half_width(), spacing);
  EXPECT_NEAR(tool.reach(), cylinder.reach(), 2.0 * spacing);
}

}  // namespace
}  // namespace hapbench::mesh_tool_test
