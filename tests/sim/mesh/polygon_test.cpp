#include "sim/mesh/polygon.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "sim/core/random.hpp"

namespace hapbench::polygon_test {
namespace {

using Polygon = std::vector<Vec3>;

Vec3 area_vector(const Polygon& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < p.size(); ++i) sum += 0.5 * (p[i] - p[0]).cross(p[i + 1] - p[0]);
  return sum;
}

DividedPolygon divided(const Polygon& polygon) {
  return PolygonDivider().divide(polygon);
}

std::string refusal_of(const Polygon& polygon) {
  try {
    divided(polygon);
  } catch (const PolygonError& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

bool is_fan(const DividedPolygon& divided) {
  for (std::uint32_t k = 0; k < divided.triangles.size(); ++k)
    if (divided.triangles[k] != TriangleCorners{0, k + 1, k + 2}) return false;
  return true;
}

/// Checks that the triangles have the polygon's area and that none is reversed. Also checks that the edges of the
/// triangles and the reversed sides of the polygon, taken together, use each edge equally often in both directions.
void expect_covered(const Polygon& polygon) {
  const DividedPolygon divided = polygon_test::divided(polygon);
  const Vec3 area = area_vector(polygon);
  double sum = 0.0;
  std::map<std::pair<std::size_t, std::size_t>, int> edges;
  const auto add = [&](std::size_t from, std::size_t to) {
    const auto first = [&](std::size_t i) { return std::ranges::find(polygon, polygon[i]) - polygon.begin(); };
    const auto a = static_cast<std::size_t>(first(from)), b = static_cast<std::size_t>(first(to));
    if (a == b) return;
    ++edges[{a, b}];
    --edges[{b, a}];
  };
  for (const auto& t : divided.triangles) {
    const double part = area_vector({polygon[t[0]], polygon[t[1]], polygon[t[2]]}).dot(area.normalized());
    EXPECT_GE(part, -1e-6 * area.norm());
    sum += std::abs(part);
    for (std::size_t k = 0; k < 3; ++k) add(t[k], t[(k + 1) % 3]);
  }
  EXPECT_NEAR(sum, area.norm(), 1e-6 * area.norm());
  for (std::size_t i = 0; i < polygon.size(); ++i) add((i + 1) % polygon.size(), i);
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
}

Polygon rotated(Polygon polygon, std::size_t by) {
  std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(by), polygon.end());
  return polygon;
}

/// Calls expect_covered(), and checks that each triangle is higher than the rounding of single precision.
void expect_covered_without_flat_triangles(const Polygon& polygon) {
  expect_covered(polygon);
  for (const auto& [i, j, k] : divided(polygon).triangles) {
    const Vec3 &a = polygon[i], &b = polygon[j], &c = polygon[k];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    EXPECT_GT((b - a).cross(c - a).norm() / longest, 1e-3);
  }
}

/// An L-shaped polygon with the area 24 - 6 = 18 mm^2.
const Polygon kL = {{6, 2, 0}, {6, 4, 0}, {0, 4, 0}, {0, 0, 0}, {3, 0, 0}, {3, 2, 0}};

TEST(Polygon, IsAFanIfItIsConvex) {
  Random random(1);
  for (std::size_t n = 4; n < 40; ++n) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(random.uniform(), random.direction()));
    Polygon polygon;
    for (std::size_t i = 0; i < n; ++i) {
      const double a = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      polygon.push_back(turn * Vec3(3.0 * std::cos(a), std::sin(a), 0.0) + Vec3(5, 6, 7));
    }
    EXPECT_TRUE(is_fan(divided(polygon))) << n;
    // Add corners on the sides, and round to single precision far from the origin.
    Polygon with_middles;
    for (std::size_t i = 0; i < n; ++i) {
      with_middles.push_back(polygon[i]);
      with_middles.push_back(0.5 * (polygon[i] + polygon[(i + 1) % n]));
    }
    for (Vec3& p : with_middles) p = (p + Vec3(500, 0, 0)).cast<float>().cast<double>();
    for (std::size_t by : {0u, 1u}) expect_covered_without_flat_triangles(rotated(with_middles, by));
  }
  // Check polygons without area.
  EXPECT_TRUE(is_fan(divided({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}})));
  EXPECT_TRUE(is_fan(divided({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}})));
}

/// Checks polygons with additional corners on their sides. No triangle may consist of three corners on one side: in a
/// mesh, the polygon beyond this side might be divided into a triangle with the same three corners.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): checks every polygon and its variants.
TEST(Polygon, HasNoFlatTrianglesIfItsCornersAreOnALine) {
  Random random(5);
  const Polygon square = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const Polygon triangle = {{0, 0, 0}, {9, 1, 0}, {2, 5, 0}};
  for (const Polygon& outline : {square, triangle, kL}) {
    for (std::size_t middles = 1; middles < 5; ++middles) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(3.0 * random.uniform(), random.direction()));
      Polygon flat;
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec3 &a = outline[i], &b = outline[(i + 1) % outline.size()];
        for (std::size_t k = 0; k <= middles; ++k)
          flat.emplace_back(a + static_cast<double>(k) / static_cast<double>(middles + 1) * (b - a));
      }
      for (std::size_t by = 0; by < flat.size(); ++by) {
        SCOPED_TRACE(testing::Message() << outline.size() << " sides with " << middles << " corners, from " << by);
        Polygon polygon = rotated(flat, by);
        expect_covered_without_flat_triangles(polygon);
        for (Vec3& p : polygon) p = turn * p + Vec3(1, 2, 3);
        expect_covered_without_flat_triangles(polygon);
        for (Vec3& p : polygon) p = p.cast<float>().cast<double>();
        expect_covered_without_flat_triangles(polygon);
      }
    }
  }
  const Polygon repeated = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}};
  expect_covered_without_flat_triangles(repeated);
  EXPECT_EQ(divided(repeated).repeated_corners, 2u);
}

TEST(Polygon, IsCoveredOnceIfItHasReflexCorners) {
  Polygon comb;
  for (int i = 0; i <= 20; ++i) comb.emplace_back(i, i % 2 == 0 ? 0.0 : 0.9, 0.0);
  comb.insert(comb.end(), {{20, 1, 0}, {0, 1, 0}});
  Polygon spiral;  // a corridor of width 0.4 that winds three times
  for (int i = 0; i <= 60; ++i)
    spiral.emplace_back((1 + 0.1 * i) * std::cos(0.3 * i), (1 + 0.1 * i) * std::sin(0.3 * i), 0);
  for (int i = 60; i >= 0; --i)
    spiral.emplace_back((1.4 + 0.1 * i) * std::cos(0.3 * i), (1.4 + 0.1 * i) * std::sin(0.3 * i), 0);
  std::reverse(spiral.begin(), spiral.end());
  const Polygon with_middles = {{6, 2, 0}, {6, 3, 0}, {6, 4, 0}, {3, 4, 0}, {0, 4, 0}, {0, 2, 0},
                                {0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {3, 1, 0}, {3, 2, 0}, {4, 2, 0}};
  const Polygon ring = {
      {0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},  // an outline, and a hole connected by a bridge
      {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  const Polygon star_with_touch = {{0, 0, 0}, {4, 0, 0}, {2, 2, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 0}};
  const Polygon dart = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {1, 1, 0}};
  Random random(2);
  for (const Polygon& flat : {kL, comb, spiral, with_middles, ring, star_with_touch, dart}) {
    for (std::size_t by = 0; by < flat.size(); ++by) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(random.uniform(), random.direction()));
      SCOPED_TRACE(testing::Message() << flat.size() << " corners from " << by);
      Polygon polygon = rotated(flat, by);
      for (Vec3& p : polygon) p = turn * p + Vec3(1, 2, 3);
      expect_covered(polygon);
      std::reverse(polygon.begin(), polygon.end());
      expect_covered(polygon);
      for (Vec3& p : polygon) p = p.cast<float>().cast<double>();
      expect_covered(polygon);
    }
  }
}

TEST(Polygon, IsCoveredOnceForRandomOutlines) {
  Random random(3);
  for (int round = 0; round < 500; ++round) {
    // The polygon is star-shaped around the origin, not around the first corner. It has repeated corners and corners on
    // sides.
    Polygon polygon;
    const int n = 4 + static_cast<int>(random.below(30));
    for (int i = 0; i < n; ++i) {
      const double a = 2.0 * std::numbers::pi * i / n, r = 0.1 + random.uniform();
      const Vec3 p(r * std::cos(a), r * std::sin(a), 1e-4 * random.uniform());
      if (!polygon.empty() && random.below(4) == 0) polygon.push_back(0.5 * (polygon.back() + p));
      polygon.push_back(p);
      if (random.below(8) == 0) polygon.push_back(p);
    }
    SCOPED_TRACE(round);
    const DividedPolygon divided = polygon_test::divided(polygon);
    if (!is_fan(divided)) expect_covered(polygon);
  }
}

TEST(Polygon, IsRefusedIfItCrossesItself) {
  const std::string crossing = refusal_of({{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {1, 5, 0}});
  EXPECT_EQ(
      crossing,
      "crosses itself: the edge between its corners 3 and 4 crosses the edge between its corners 1 and 2; allowed: a "
      "simple polygon");
  EXPECT_NE(refusal_of({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).find("crosses itself"), std::string::npos);
  Polygon pentagram, twice;
  for (int i = 0; i < 5; ++i)
    pentagram.emplace_back(std::cos(0.8 * std::numbers::pi * i), std::sin(0.8 * std::numbers::pi * i), 0);
  EXPECT_NE(refusal_of(pentagram).find("crosses itself"), std::string::npos);
  for (int i = 0; i < 8; ++i)
    twice.push_back(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}[static_cast<std::size_t>(i % 4)]);
  EXPECT_NE(refusal_of(twice).find("crosses itself"), std::string::npos);
  // Check a figure of eight through one corner.
  EXPECT_NE(refusal_of({{0, 0, 0}, {1, 1, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}, {0, 2, 0}}).find("crosses itself"),
            std::string::npos);
}

TEST(Polygon, IsRefusedIfItIsClearlyNotPlanar) {
  EXPECT_NE(
      refusal_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}}).find("is not planar: a corner is off its plane by 1"),
      std::string::npos);
  Polygon bent = kL;
  bent[4].z() = 3.0;
  EXPECT_NE(refusal_of(bent).find("is not planar"), std::string::npos);
  // Quadrilaterals of a curved surface, which are nearly planar, are still accepted.
  const DividedPolygon curved = divided({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2}, {0, 1, 0}});
  EXPECT_TRUE(is_fan(curved));
  EXPECT_NEAR(curved.unevenness, 0.034, 0.002);
}

TEST(Polygon, MayHaveManyCorners) {
  Polygon comb;
  for (int i = 0; i <= 2000; ++i) comb.emplace_back(i, i % 2 == 0 ? 0.0 : 900.0, 0.0);
  comb.insert(comb.end(), {{2000, 1000, 0}, {0, 1000, 0}});
  expect_covered(comb);
  Polygon more;
  for (int i = 0; i < 19'998; ++i) more.emplace_back(i, i % 2 == 0 ? 0.0 : 900.0, 0.0);
  more.insert(more.end(), {{20'000, 1000, 0}, {0, 1000, 0}});
  EXPECT_NE(refusal_of(more).find("has 20000 corners and is not convex; allowed: at most 10000"), std::string::npos);
}

}  // namespace
}  // namespace hapbench::polygon_test
