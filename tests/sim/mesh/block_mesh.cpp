#include <cstdio>
#include <cstdlib>
#include <string>

#include "sim/mesh/marching_cubes.hpp"

/// Prints the mesh that marching cubes computes for a block with a hole: numbers of vertices and faces, then the
/// vertices and faces.
int main(int count, char** arguments) {
  using namespace hapbench;
  if (count != 8) return 2;
  const auto number = [arguments](int i) { return std::strtod(arguments[i], nullptr); };
  const BlockWithHole block{{number(1), number(2), number(3)}, number(4), number(5)};
  const Density density = arguments[7] == std::string("binary") ? Density::binary : Density::signed_distance;
  const IsoSurface surface = marching_cubes(density_field(block, number(6), density), {.triangles = true});
  std::printf("%zu %zu\n", surface.vertices.size(), surface.triangles.size());
  for (const SurfacePoint& v : surface.vertices)
    std::printf("%.17g %.17g %.17g\n", v.position.x(), v.position.y(), v.position.z());
  for (const auto& [i, j, k] : surface.triangles) std::printf("%u %u %u\n", i, j, k);
  return 0;
}
