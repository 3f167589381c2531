#include "sim/mesh/marching_cubes.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>

#include "sim/contact/grid_index.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::surface_shell_test {
namespace {

/// What it is by definition.
PointShell vertices_in_grid_order(const DensityField& field) {
  std::vector<SurfacePoint> vertices = marching_cubes(field).vertices;
  std::erase_if(vertices, [](const SurfacePoint& vertex) { return vertex.normal.isZero(0.0); });
  return {in_grid_order(vertices, field.spacing), field.spacing};
}

/// Every bit of every column, padding included.
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
    // 71 nodes along x, more than a word of them.
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
    // The vertices around an outside node of distance 0 lie in it, and a triangle of three of them has no area.
    field.signed_distance = [noise = field.signed_distance](const Vec3& p) { return std::min(noise(p), 0.0); };
    const PointShell shell = surface_shell(field);
    without += marching_cubes(field).vertices.size() - shell.size();
    expect_same(shell, vertices_in_grid_order(field));
  }
  EXPECT_GT(without, 0u);
}

TEST(SurfaceShell, OfNothingIsEmpty) {
  DensityField field = test::noise(1);
  field.signed_distance = [](const Vec3&) { return 1e-9; };
  expect_same(surface_shell(field), PointShell({}, field.spacing));
}

}  // namespace
}  // namespace hapbench::surface_shell_test
