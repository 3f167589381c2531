#include "sim/mesh/marching_cubes.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <set>

#include "sim/core/random.hpp"
#include "sim/geometry/grid_index.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::marching_cubes_test {
namespace {

using test::cases;
using test::enclosed_volume;

using Edge = std::pair<std::uint32_t, std::uint32_t>;

IsoSurface surface_of(const DensityField& field) {
  return marching_cubes(field, {.triangles = true, .cells = true});
}

/// Checks that each edge of the surface is used once in each direction, so that the surface is closed and consistently
/// wound. Also checks that the triangles around each vertex form one fan, so that the surface is a manifold.
void expect_closed_manifold(const IsoSurface& surface) {
  std::map<Edge, std::uint32_t> opposite;  // for each directed edge, the corner opposite to the edge
  std::vector<std::size_t> triangles(surface.vertices.size());
  for (const auto& t : surface.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ++triangles[t[i]];
      ASSERT_TRUE(opposite.emplace(Edge{t[i], t[(i + 1) % 3]}, t[(i + 2) % 3]).second) << "used twice";
    }
  }
  for (const auto& [edge, corner] : opposite) ASSERT_TRUE(opposite.contains({edge.second, edge.first})) << "open";
  std::map<std::uint32_t, std::uint32_t> some_neighbour;
  for (const auto& [edge, corner] : opposite) some_neighbour[edge.first] = edge.second;
  ASSERT_EQ(some_neighbour.size(), surface.vertices.size());
  for (const auto& [vertex, first] : some_neighbour) {
    std::size_t fan = 0;
    std::uint32_t neighbour = first;
    do {
      neighbour = opposite.at({vertex, neighbour});
    } while (++fan <= triangles[vertex] && neighbour != first);
    ASSERT_EQ(fan, triangles[vertex]) << vertex;
  }
}

long euler_characteristic_of(const IsoSurface& surface) {
  const auto faces = static_cast<long>(surface.triangles.size());
  return static_cast<long>(surface.vertices.size()) - faces * 3 / 2 + faces;
}

/// Returns a block that is small, so that tests with sanitizers finish in time.
BlockWithHole small_block() {
  BlockWithHole block;
  block.size = {0.004, 0.005, 0.004};
  block.hole_depth = 0.002;
  return block;
}

double exact_volume(const BlockWithHole& b) {
  return b.size.prod() - std::numbers::pi * b.hole_diameter * b.hole_diameter / 4 * b.hole_depth;
}

class MarchingCubesOfDensity : public testing::TestWithParam<Density> {};
INSTANTIATE_TEST_SUITE_P(Both, MarchingCubesOfDensity, testing::Values(Density::signed_distance, Density::binary),
                         [](const auto& d) { return d.param == Density::binary ? "binary" : "signed_distance"; });

TEST_P(MarchingCubesOfDensity, BlockIsClosedHasNoHandlesAndTheRightVolume) {
  const BlockWithHole block = small_block();
  const IsoSurface surface = surface_of(density_field(block, 0.0001, GetParam()));
  expect_closed_manifold(surface);
  EXPECT_EQ(euler_characteristic_of(surface), 2);  // a blind hole does not change the topology
  // Edges of the block and of the hole, 65 mm in total, are bevelled. With the grid spacing g = 0.1 mm, the missing
  // cross-section is g^2/8 = 1.25e-3 mm^2: 0.08 of 74 mm^3, 0.1 %. The binary wall deviates by less than a cell in
  // either direction.
  EXPECT_NEAR(enclosed_volume(test::half_edge_mesh(surface)) / exact_volume(block), 1.0, 0.005);
}

TEST_P(MarchingCubesOfDensity, NormalsAreThoseOfTheMesh) {
  // OpenMesh sums the same unit normals in another order: up to a dozen terms, each exact to a few roundings.
  IsoSurface surface = surface_of(density_field(small_block(), 0.0002, GetParam()));
  const std::vector<SurfacePoint> expected = vertices_with_normals(test::half_edge_mesh(surface));
  std::erase_if(surface.vertices, [](const SurfacePoint& vertex) { return vertex.normal.isZero(0.0); });
  ASSERT_EQ(surface.vertices.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_LE((surface.vertices[i].normal - expected[i].normal).norm(), 1e-14) << i;
}

bool same(const IsoSurface& a, const IsoSurface& b) {
  const auto same_points = [](const SurfacePoint& p, const SurfacePoint& q) {
    return p.position == q.position && p.normal == q.normal;
  };
  return std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(), same_points) &&
         a.triangles == b.triangles && a.cells.centres == b.cells.centres && a.cells.starts == b.cells.starts &&
         a.cells.vertices == b.cells.vertices;
}

TEST(MarchingCubes, NarrowBandFindsWhatAFullSweepFinds) {
  // Compare the surfaces of a field of exact distances, which lets marching cubes skip nodes far from the surface, and
  // of the same field scaled down, so that no node is skipped.
  const BlockWithHole block = small_block();
  DensityField field = density_field(block, 0.0002, Density::signed_distance);
  const IsoSurface band = surface_of(field);
  field.signed_distance = [block](const Vec3& p) { return 0x1p-20 * signed_distance(block, p); };
  EXPECT_TRUE(same(band, surface_of(field)));  // scaling by a power of two changes no bit
}

TEST(MarchingCubes, DoesNotDependOnTheNumberOfThreads) {
  const DensityField field = density_field(small_block(), 0.0001, Density::signed_distance);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return surface_of(field);
  };
  const IsoSurface one = with(1);
  for (const std::size_t threads : {2u, 3u, 8u}) EXPECT_TRUE(same(one, with(threads))) << threads;
}

TEST(MarchingCubes, NoiseGivesClosedManifoldSurfacesWhateverTheCase) {
  for (std::uint64_t seed = 1; seed <= cases(60); ++seed) {
    const IsoSurface surface = surface_of(test::noise(seed));
    expect_closed_manifold(surface);
    const HalfEdgeMesh mesh = test::half_edge_mesh(surface);
    EXPECT_EQ(euler_characteristic_of(surface), test::euler_characteristic(mesh));
    EXPECT_GT(surface.triangles.size(), 100u);
    EXPECT_GT(enclosed_volume(mesh), 0.0);  // triangles are counter-clockwise from outside
  }
}

TEST(CubeCases, UseEveryCrossedEdgeAndNoOther) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    unsigned used = 0, crossed = 0;
    for (const CubeTriangle& triangle : cube_triangles(inside)) {
      for (const int edge : triangle) used |= 1u << edge;
    }
    for (int c = 0; c < 8; ++c) {
      for (int axis = 0; axis < 3; ++axis) {
        if ((c >> axis & 1) == 0 && ((inside >> c ^ inside >> (c | 1 << axis)) & 1u) != 0)
          crossed |= 1u << (3 * c + axis);
      }
    }
    EXPECT_EQ(used, crossed) << inside;
  }
}

using Coordinates = std::array<double, 3>;

Coordinates coordinates(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

/// A surface with its cells and its grid spacing [m].
struct Surface : IsoSurface {
  explicit Surface(const DensityField& field)
      : IsoSurface(marching_cubes(field, {.cells = true})), spacing(field.spacing) {}
  ShellPoints shell() const { return points_by_cell(*this, spacing); }

  double spacing;
};

/// Returns the numbers of the cells that list each position.
std::map<Coordinates, std::multiset<std::uint32_t>> cells_of_positions(const ShellPoints& shell) {
  std::map<Coordinates, std::multiset<std::uint32_t>> cells;
  for (std::size_t i = 0; i < shell.points.size(); ++i) {
    cells[coordinates(shell.points[i].position)].insert(shell.cells[i]);
  }
  return cells;
}

/// Returns the number of cells for each number of points in a cell.
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
  // Thesis C.2 on the number of points per cell: "at least one and at most 5".
  EXPECT_EQ(histogram(shell), (std::map<std::size_t, std::size_t>{{3, 52}, {4, 108'906}, {5, 44}}));
}

TEST(PointsByCell, ListEachVertexOnceForEachCellAroundItsEdge) {
  // The surface crosses the edge of a vertex, so it cuts all four cells around this edge. In a noise field, two
  // vertices may lie at the same position, in the corner where their edges meet; each position is then listed for a
  // multiple of four cells.
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
    // The numbers of the cells are consecutive, without a gap, as the local average requires.
    ASSERT_TRUE(shell.cells[i] == next || shell.cells[i] + 1 == next) << i;
    if (shell.cells[i] == next) ++next;
  }
  EXPECT_EQ(next, surface.cells.centres.size());
  EXPECT_EQ(PointShell(shell.points, 0.0002, shell.cells).cell_of_points(), shell.cells);
}

/// Returns the result of surface_shell as its documentation defines it: all vertices with a normal, in grid order.
PointShell vertices_in_grid_order(const DensityField& field) {
  std::vector<SurfacePoint> vertices = marching_cubes(field).vertices;
  std::erase_if(vertices, [](const SurfacePoint& vertex) { return vertex.normal.isZero(0.0); });
  return {in_grid_order(vertices, field.spacing), field.spacing};
}

/// Checks that every bit of every column is equal, including the padding.
void expect_same(const PointShell& a, const PointShell& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(a.padded_size(), b.padded_size());
  EXPECT_EQ(a.cell_size(), b.cell_size());
  EXPECT_EQ(a.bounds().min, b.bounds().min);
  EXPECT_EQ(a.bounds().max, b.bounds().max);
  for (const auto column :
       {&PointShell::x, &PointShell::y, &PointShell::z, &PointShell::nx, &PointShell::ny, &PointShell::nz}) {
    EXPECT_TRUE(std::equal((a.*column)(), (a.*column)() + a.padded_size(), (b.*column)()));
  }
}

TEST(SurfaceShell, IsTheVerticesInTheOrderOfTheirGridWhateverTheNumberOfThreads) {
  for (const Density density : {Density::signed_distance, Density::binary}) {
    // The block has 71 nodes along x, more than the bits of a 64-bit word.
    const DensityField field = density_field({{0.0067, 0.005, 0.004}, 0.002, 0.002}, 0.0001, density);
    const PointShell expected = vertices_in_grid_order(field);
    ASSERT_GT(expected.size(), 10'000u);
    for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      expect_same(surface_shell(field), expected);
    }
  }
}

TEST(SurfaceShell, LeavesOutVerticesWithoutANormal) {
  std::size_t without = 0;
  for (std::uint64_t seed = 1; seed <= test::cases(30); ++seed) {
    DensityField field = test::noise(seed);
    // The vertices around an outside node with the distance 0 lie in the node, and a triangle of three such vertices
    // has no area.
    field.signed_distance = [noise = field.signed_distance](const Vec3& p) { return std::min(noise(p), 0.0); };
    const PointShell shell = surface_shell(field);
    without += marching_cubes(field).vertices.size() - shell.size();
    expect_same(shell, vertices_in_grid_order(field));
  }
  EXPECT_GT(without, 0u);
}

}  // namespace
}  // namespace hapbench::marching_cubes_test
