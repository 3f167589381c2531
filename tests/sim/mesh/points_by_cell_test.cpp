#include "sim/mesh/marching_cubes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>

#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::points_by_cell_test {
namespace {

using Coordinates = std::array<double, 3>;

Coordinates coordinates(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

/// A surface with its cells, and what is made of it.
struct Surface : IsoSurface {
  explicit Surface(const DensityField& field)
      : IsoSurface(marching_cubes(field, {.cells = true})), spacing(field.spacing) {}
  ShellPoints shell() const { return points_by_cell(*this, spacing); }

  double spacing;
};

/// The numbers of the cells that list each position.
std::map<Coordinates, std::multiset<std::uint32_t>> cells_of_positions(const ShellPoints& shell) {
  std::map<Coordinates, std::multiset<std::uint32_t>> cells;
  for (std::size_t i = 0; i < shell.points.size(); ++i) {
    cells[coordinates(shell.points[i].position)].insert(shell.cells[i]);
  }
  return cells;
}

/// How many cells have so many points.
std::map<std::size_t, std::size_t> histogram(const ShellPoints& shell) {
  std::map<std::uint32_t, std::size_t> sizes;
  for (const std::uint32_t cell : shell.cells) ++sizes[cell];
  std::map<std::size_t, std::size_t> count;
  for (const auto& [cell, size] : sizes) ++count[size];
  return count;
}

TEST(PointsByCell, OfTheThesisBlockAreAtMostFiveInACellAndFourForEachVertex) {
  const Surface surface(density_field(BlockWithHole(), 0.0001, Density::signed_distance));
  const ShellPoints shell = surface.shell();
  EXPECT_EQ(surface.vertices.size(), 109'000u);
  EXPECT_EQ(shell.points.size(), 436'000u);
  // Thesis C.2: "at least one and at most 5".
  EXPECT_EQ(histogram(shell), (std::map<std::size_t, std::size_t>{{3, 52}, {4, 108'906}, {5, 44}}));
}

TEST(PointsByCell, ListEachVertexOnceForEachCellAroundItsEdge) {
  // The surface crosses the edge of a vertex, so it cuts all four cells around that edge. Two vertices of noise may lie
  // at one place, in the corner where their edges meet; then the sets of their cells are equally many times four.
  for (std::uint64_t seed = 1; seed <= test::cases(30); ++seed) {
    const Surface surface(test::noise(seed));
    const ShellPoints shell = surface.shell();
    std::map<Coordinates, std::size_t> vertices;
    for (const SurfacePoint& vertex : surface.vertices) {
      if (!vertex.normal.isZero(0.0)) ++vertices[coordinates(vertex.position)];
    }
    const auto cells = cells_of_positions(shell);
    ASSERT_EQ(cells.size(), vertices.size()) << seed;
    for (const auto& [position, times] : vertices) {
      ASSERT_EQ(cells.at(position).size(), 4 * times) << seed;
      const std::set<std::uint32_t> different(cells.at(position).begin(), cells.at(position).end());
      ASSERT_GE(different.size(), 4u) << seed;
    }
  }
}

TEST(PointsByCell, CutCellsHoldTheVerticesOfTheirTriangles) {
  for (std::uint64_t seed = 1; seed <= test::cases(30); ++seed) {
    const Surface surface(test::noise(seed));
    const auto& [centres, starts, vertices] = surface.cells;
    ASSERT_EQ(starts.size(), centres.size() + 1);
    ASSERT_EQ(starts.back(), vertices.size());
    const double half = 0.5 * surface.spacing * (1.0 + 1e-9);
    for (std::size_t cell = 0; cell < centres.size(); ++cell) {
      ASSERT_GE(starts[cell + 1] - starts[cell], 3u);
      ASSERT_LE(starts[cell + 1] - starts[cell], 12u);
      for (std::uint32_t i = starts[cell]; i < starts[cell + 1]; ++i) {
        ASSERT_LE((surface.vertices[vertices[i]].position - centres[cell]).cwiseAbs().maxCoeff(), half);
      }
    }
  }
}

TEST(PointsByCell, AreTheMeshsVerticesCellAfterCell) {
  const Surface surface(density_field({{0.004, 0.005, 0.004}, 0.002, 0.002}, 0.0002, Density::binary));
  const ShellPoints shell = surface.shell();
  std::map<Coordinates, Vec3> normals;
  for (const SurfacePoint& v : surface.vertices) normals[coordinates(v.position)] = v.normal;
  std::uint32_t next = 0;
  ASSERT_EQ(shell.points.size(), shell.cells.size());
  for (std::size_t i = 0; i < shell.points.size(); ++i) {
    ASSERT_EQ(shell.points[i].normal, normals.at(coordinates(shell.points[i].position)));
    // Consecutive, without a gap, as the local average numbers cells.
    ASSERT_TRUE(shell.cells[i] == next || shell.cells[i] + 1 == next) << i;
    if (shell.cells[i] == next) ++next;
  }
  EXPECT_EQ(next, surface.cells.centres.size());
  EXPECT_EQ(PointShell(shell.points, 0.0002, shell.cells).cell_of_points(), shell.cells);
}

}  // namespace
}  // namespace hapbench::points_by_cell_test
