#include "sim/mesh/marching_cubes.hpp"

#include "sim/mesh/surface_slab.hpp"

namespace hapbench {
namespace {

void append(const SurfaceSlab& slab, const NodeGrid& grid, IsoSurface& all) {
  const auto offset = static_cast<std::uint32_t>(all.vertices.size());
  for (const SurfaceLayer& layer : slab.layers) {
    for (std::size_t i = 0; i < layer.vertices.size(); ++i)
      all.vertices.push_back({position(grid, layer.vertices[i]), layer.normals[i]});
  }
  for (const auto& [a, b, c] : slab.triangles) all.triangles.push_back({a + offset, b + offset, c + offset});
  const auto listed = static_cast<std::uint32_t>(all.cells.vertices.size());
  all.cells.centres.insert(all.cells.centres.end(), slab.cells.centres.begin(), slab.cells.centres.end());
  for (const std::uint32_t vertex : slab.cells.vertices) all.cells.vertices.push_back(vertex + offset);
  for (std::size_t i = 1; i < slab.cells.starts.size(); ++i) all.cells.starts.push_back(listed + slab.cells.starts[i]);
}

}  // namespace

IsoSurface marching_cubes(const DensityField& field, KeptOfSurface kept) {
  const NodeGrid grid(field);
  std::vector<SurfaceSlab> slabs = surface_slabs(field, grid, kept);
  std::size_t vertices = 0;
  for (const SurfaceSlab& slab : slabs) {
    for (const SurfaceLayer& layer : slab.layers) vertices += layer.vertices.size();
  }
  IsoSurface surface;
  surface.vertices.reserve(vertices);
  for (SurfaceSlab& slab : slabs) {
    append(slab, grid, surface);
    slab = {};  // or memory would hold all vertices twice
  }
  return surface;
}

}  // namespace hapbench
