#include "sim/contact/rigid_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/core/random.hpp"

namespace hapbench::rigid_contact_test {
namespace {

// Tests against closed forms the free position: the position of a tool that cannot enter rigid triangles.

constexpr double kRadius = 0.0005;        // radius of the tool [m]
constexpr RoundTool kBall{kRadius, 0.0};  // a tool of which only the tip can touch
const Vec3 kDown = -Vec3::UnitZ();
constexpr double kExact = 1e-14;  // tolerance [m]: rounding in some additions of lengths of 1 cm

/// Adds the square a b c d, whose corners are counter-clockwise from outside.
void add_square(TriangleSoup& soup, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  soup.vertices.insert(soup.vertices.end(), {a, b, c, d});
  soup.triangles.push_back({first, first + 1, first + 2});
  soup.triangles.push_back({first, first + 2, first + 3});
}

TriangleSoup square(double height = 0.0) {
  TriangleSoup soup;
  add_square(soup, {-0.01, -0.01, height}, {0.01, -0.01, height}, {0.01, 0.01, height}, {-0.01, 0.01, height});
  return soup;
}

/// Returns a sphere around the origin. Starts with an octahedron and, `levels` times, divides each face into four
/// faces.
TriangleSoup sphere(double radius, int levels) {
  TriangleSoup soup;
  const auto add = [&](const auto& self, const Vec3& a, const Vec3& b, const Vec3& c, int level) -> void {
    if (level == 0) {
      const auto first = static_cast<std::uint32_t>(soup.vertices.size());
      soup.vertices.insert(soup.vertices.end(), {radius * a, radius * b, radius * c});
      soup.triangles.push_back({first, first + 1, first + 2});
      return;
    }
    const Vec3 ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
    for (const auto& [p, q, r] : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      self(self, p, q, r, level - 1);
  };
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) add(add, x * Vec3::UnitX(), y * Vec3::UnitY(), z * Vec3::UnitZ(), levels);
  return soup;
}

/// Moves the tool on a straight path in `steps` steps, and returns the last free position.
Vec3 moved(RigidContact& contact, const Vec3& from, const Vec3& to, const Vec3& axis = kDown, int steps = 20) {
  EXPECT_TRUE(contact.start(from, axis));
  Vec3 free = from;
  for (int i = 1; i <= steps; ++i) free = contact.follow(from + i * (to - from) / steps, axis);
  EXPECT_LT(contact.error(), kExact);
  EXPECT_FALSE(contact.touched_far_end());
  return free;
}

TEST(RigidContact, OnAPlaneIsAboveThePrescribedPosition) {
  RigidContact contact(square(), kBall);
  const Vec3 free = moved(contact, {0, 0, 0.001}, {0.003, 0.002, -0.0007});
  EXPECT_NEAR((free - Vec3(0.003, 0.002, kRadius)).norm(), 0.0, kExact);
  // Without contact, the free position is the prescribed position itself.
  EXPECT_EQ(contact.follow({0.001, 0, 0.0021}, kDown), Vec3(0.001, 0, 0.0021));
}

/// Checks the free position on a sphere. The triangles are inside the sphere by at most their sagitta s, and therefore
/// the tool is at most s closer to the centre.
TEST(RigidContact, OnASphereIsRadial) {
  constexpr double kLarge = 0.004;
  constexpr int kLevels = 6;
  // The longest edge of a face of the octahedron spans 90 degrees; each division halves it, with a distortion of at
  // most pi / 2 on the sphere. The sagitta of a triangle with edges of the angle e is at most R (1 - cos(e / sqrt(3))).
  const double edge = std::numbers::pi * std::numbers::pi / 4.0 / (1 << kLevels);
  const double sagitta = kLarge * (1.0 - std::cos(edge / std::sqrt(3.0)));
  RigidContact contact(sphere(kLarge, kLevels), kBall);
  const Vec3 start(0, 0, 0.006);
  ASSERT_TRUE(contact.start(start, kDown));
  for (int i = 0; i <= 400; ++i) {
    const double angle = 0.005 * i, reach = kLarge + kRadius - std::min(1e-6 * i, 2e-4);
    const Vec3 wanted = reach * Vec3(std::sin(angle), 0.3 * std::sin(angle), std::cos(angle)).normalized();
    const Vec3 free = contact.follow(wanted, kDown), out = wanted.normalized();
    EXPECT_GE(free.dot(out), std::min(reach, kLarge + kRadius - sagitta) - kExact);
    EXPECT_LE(free.norm(), kLarge + kRadius + kExact);
    // The normal of a triangle differs from the radial direction by at most the angle of an edge.
    const double depth = (free - wanted).norm();
    if (depth > 5e-5) {
      EXPECT_LT((free - wanted).cross(out).norm() / depth, edge);
    }
  }
  EXPECT_LT(contact.error(), 1e-10);
}

/// Checks the free position at a convex edge, around which the tip's centre moves on a cylinder.
TEST(RigidContact, OnAnEdgeIsRadial) {
  TriangleSoup soup;  // x < 0 and z < 0 is solid
  add_square(soup, {-0.01, -0.01, 0}, {0, -0.01, 0}, {0, 0.01, 0}, {-0.01, 0.01, 0});
  add_square(soup, {0, -0.01, -0.01}, {0, 0.01, -0.01}, {0, 0.01, 0}, {0, -0.01, 0});
  RigidContact contact(soup, kBall);
  ASSERT_TRUE(contact.start({-0.001, 0, 0.001}, kDown));
  for (int i = 0; i <= 90; ++i) {
    // Moves from the upper face around the edge to the side face, at a depth of 0.1 mm.
    const double angle = std::numbers::pi / 180.0 * i;
    const Vec3 out(std::sin(angle), 0, std::cos(angle));
    const Vec3 wanted = Vec3(0, 1e-5 * i, 0) + (kRadius - 1e-4) * out;
    const Vec3 free = contact.follow(wanted, kDown);
    // Each move of the search reduces its error by the factor depth / radius = 1/5, and the search ends at 1e-12 of the
    // radius.
    EXPECT_NEAR((free - wanted - 1e-4 * out).norm(), 0.0, 2e-15) << i;
  }
}

TEST(RigidContact, InAGrooveTouchesBothWalls) {
  TriangleSoup soup;  // walls at 30 and 50 degrees from the vertical, which meet on the y axis
  const double left = std::numbers::pi / 6.0, right = std::numbers::pi / 3.6;
  const Vec3 a = 0.01 * Vec3(-std::sin(left), 0, std::cos(left)), b = 0.01 * Vec3(std::sin(right), 0, std::cos(right));
  const Vec3 along(0, 0.01, 0);
  add_square(soup, -along, along, a + along, a - along);
  add_square(soup, along, -along, b - along, b + along);
  RigidContact contact(soup, kBall);
  const Vec3 free = moved(contact, {0, 0, 0.005}, {1e-4, 0.002, 0.0002});
  // The tip's centre is at the distance of its radius from both walls.
  const double half = 0.5 * (left + right), distance = kRadius / std::sin(half), turn = 0.5 * (right - left);
  EXPECT_NEAR((free - Vec3(distance * std::sin(turn), 0.002, distance * std::cos(turn))).norm(), 0.0, kExact);
}

TEST(RigidContact, StaysOnTheSideFromWhichItCame) {
  TriangleSoup plate = square(0.0);
  const TriangleSoup below = square(-1e-5);
  for (const TriangleCorners& t : below.triangles) plate.triangles.push_back({t[0] + 4, t[2] + 4, t[1] + 4});
  plate.vertices.insert(plate.vertices.end(), below.vertices.begin(), below.vertices.end());
  RigidContact contact(plate, kBall);
  for (const double depth : {0.002, 0.005}) {
    const Vec3 free = moved(contact, {0, 0, 0.001}, {0.001, 0, -depth}, kDown, 1);  // in a single jump
    EXPECT_NEAR((free - Vec3(0.001, 0, kRadius)).norm(), 0.0, kExact);
  }
}

/// Checks that the side of a tilted tool rests on the edge of a wall: the distance between tool axis and edge is the
/// tool's radius.
TEST(RigidContact, SideOfTheToolTouchesAnEdge) {
  TriangleSoup wall;  // a vertical wall in the plane x = 0 below z = 0, whose upper edge is the y axis
  add_square(wall, {0, -0.01, -0.01}, {0, 0.01, -0.01}, {0, 0.01, 0}, {0, -0.01, 0});
  const RoundTool tool{kRadius, 0.01};
  RigidContact contact(wall, tool);
  // The tip is beside the wall and below the edge, and the tool leans over the edge.
  const double tilt = 0.5;
  const Vec3 axis(std::sin(tilt), 0, -std::cos(tilt));
  // The normal from the edge to the axis is perpendicular to edge and axis.
  const Vec3 normal(std::cos(tilt), 0, std::sin(tilt));
  const Vec3 from = Vec3(0, 0, 0) + 0.002 * axis + 0.001 * normal, to = from - 0.0007 * normal;
  const Vec3 free = moved(contact, from, to, axis);
  EXPECT_NEAR((free - to - 0.0002 * normal).norm(), 0.0, kExact);
}

TEST(RigidContact, ReportsThatItStartsInContactOrTouchesTheFarEnd) {
  RigidContact contact(square(), {kRadius, 0.002});
  EXPECT_FALSE(contact.start({0, 0, 0.9 * kRadius}, kDown));
  EXPECT_TRUE(contact.start({0, 0, 1.1 * kRadius}, kDown));
  contact.follow({0, 0, 0.5 * kRadius}, kDown);
  EXPECT_FALSE(contact.touched_far_end());
  // The tool is upside down: the end opposite to the tip is at the bottom.
  ASSERT_TRUE(contact.start({0, 0, 0.004}, -kDown));
  contact.follow({0, 0, 0.002}, -kDown);
  EXPECT_TRUE(contact.touched_far_end());
}

/// Checks that free positions satisfy all constraints, and that no free position nearby is closer to the prescribed
/// position. Nearby positions are sampled at random.
TEST(RigidContact, IsALocalMinimumAmongFreePositions) {
  Random random(3);
  TriangleSoup rough;
  for (int i = 0; i < 40; ++i) {
    const Vec3 middle(0.001 * (2.0 * random.uniform() - 1.0), 0.001 * (2.0 * random.uniform() - 1.0), -0.0003);
    const auto first = static_cast<std::uint32_t>(rough.vertices.size());
    for (int k = 0; k < 3; ++k) rough.vertices.push_back(middle + 4e-4 * random.direction());
    rough.triangles.push_back({first, first + 1, first + 2});
  }
  RigidContact contact(rough, kBall), probe(rough, kBall);
  ASSERT_TRUE(contact.start({0, 0, 0.002}, kDown));
  for (int i = 0; i < 200; ++i) {
    const Vec3 wanted(4e-4 * std::sin(0.05 * i), 3e-4 * std::cos(0.031 * i), i < 50 ? 0.002 - 3.4e-5 * i : 0.0003);
    const Vec3 free = contact.follow(wanted, kDown);
    const double distance = (free - wanted).norm();
    EXPECT_TRUE(probe.start(free + 1e-13 * unit_or(free - wanted, Vec3::UnitZ()), kDown)) << "touches a triangle";
    for (int k = 0; k < 50; ++k) {
      const Vec3 other = free + 1e-7 * random.direction();
      const bool is_closer = (other - wanted).norm() < distance - 1e-9;
      EXPECT_FALSE(is_closer && probe.start(other, kDown)) << i;
    }
  }
}

}  // namespace
}  // namespace hapbench::rigid_contact_test
