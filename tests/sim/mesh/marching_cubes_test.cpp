#include "sim/mesh/marching_cubes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/core/random.hpp"
#include "sim/mesh/block_field.hpp"
#include "sim/mesh/cube_cases.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

namespace hapbench {
namespace {

using test::cases;
using test::enclosed_volume;
using test::euler_characteristic;

std::size_t boundary_edges(const HalfEdgeMesh& mesh) {
  std::size_t count = 0;
  for (const auto edge : mesh.edges()) count += mesh.is_boundary(edge) ? 1u : 0u;
  return count;
}

/// A small block, so that the sanitizers finish too; the spacing of the thesis's.
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
  const HalfEdgeMesh mesh = marching_cubes(density_field(block, 0.0001, GetParam()));
  EXPECT_EQ(boundary_edges(mesh), 0u);
  EXPECT_EQ(euler_characteristic(mesh), 2);  // a blind hole is a dent
  // Edges of the block and of the hole, 65 mm in all, are bevelled by g^2/8 = 1.25e-3 mm^2: 0.08 of 74 mm^3, 0.1 %. The
  // binary wall wobbles by less than a cell either way.
  EXPECT_NEAR(enclosed_volume(mesh) / exact_volume(block), 1.0, 0.005);
}

TEST_P(MarchingCubesOfDensity, EveryVertexLiesWithinACellOfTheSurface) {
  const BlockWithHole block = small_block();
  const HalfEdgeMesh mesh = marching_cubes(density_field(block, 0.0001, GetParam()));
  for (const SurfacePoint& p : vertices_with_normals(mesh)) {
    // On an edge of the grid whose ends lie on both sides: at most its length away.
    ASSERT_LE(std::abs(signed_distance(block, p.position)), 0.0001);
    ASSERT_NEAR(p.normal.norm(), 1.0, 1e-15);
  }
}

TEST(MarchingCubes, FlatFacesOfASignedDistanceAreExact) {
  const BlockWithHole block = small_block();
  std::size_t on_top = 0;
  for (const SurfacePoint& p :
       vertices_with_normals(marching_cubes(density_field(block, 0.0001, Density::signed_distance)))) {
    const bool inner = std::abs(p.position.x()) < 0.0018 && std::abs(p.position.y()) < 0.0023 &&
                       std::hypot(p.position.x(), p.position.y()) > 0.0012;
    if (!inner || p.position.z() < -0.0001) continue;
    ++on_top;
    // Linear interpolation of a linear field: exact to the rounding of coordinates near 1e-3.
    EXPECT_NEAR(p.position.z(), 0.0, 1e-18);
    EXPECT_NEAR(p.normal.z(), 1.0, 1e-12);
  }
  EXPECT_GT(on_top, 500u);
}

TEST(MarchingCubes, WallNormalsOfASignedDistanceAreWithinTwoDegrees) {
  const BlockWithHole block = small_block();
  double worst = 0.0;
  for (const SurfacePoint& p :
       vertices_with_normals(marching_cubes(density_field(block, 0.0001, Density::signed_distance)))) {
    const double rho = std::hypot(p.position.x(), p.position.y());
    if (std::abs(rho - 0.001) > 0.0001 || p.position.z() > -0.0003 || p.position.z() < -0.0017) continue;
    const Vec3 inward(-p.position.x() / rho, -p.position.y() / rho, 0.0);
    worst = std::max(worst, std::acos(std::min(1.0, inward.dot(p.normal))));
  }
  EXPECT_GT(worst, 0.0);
  EXPECT_LT(worst * 180 / std::numbers::pi, 2.0);
}

TEST(MarchingCubes, NarrowBandFindsWhatAFullSweepFinds) {
  // The same field, once exact and once scaled down so that no block of cells is ever skipped.
  const BlockWithHole block = small_block();
  DensityField field = density_field(block, 0.0002, Density::signed_distance);
  const HalfEdgeMesh band = marching_cubes(field);
  field.signed_distance = [block](const Vec3& p) { return 0x1p-20 * signed_distance(block, p); };
  const HalfEdgeMesh full = marching_cubes(field);
  ASSERT_EQ(band.n_vertices(), full.n_vertices());
  ASSERT_EQ(band.n_faces(), full.n_faces());
  for (const auto v : band.vertices()) ASSERT_EQ(band.point(v), full.point(v));  // a power of two changes no bit
}

TEST(MarchingCubes, NoiseGivesClosedManifoldSurfacesWhateverTheCase) {
  for (std::uint64_t seed = 1; seed <= cases(60); ++seed) {
    const HalfEdgeMesh mesh = marching_cubes(test::noise(seed));  // throws when a face does not fit
    EXPECT_EQ(boundary_edges(mesh), 0u) << seed;
    EXPECT_GT(mesh.n_faces(), 100u);
    EXPECT_GT(enclosed_volume(mesh), 0.0);  // faces are counter-clockwise from outside
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

}  // namespace
}  // namespace hapbench
