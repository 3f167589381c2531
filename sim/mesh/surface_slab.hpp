#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/mesh/marching_cubes.hpp"
#include "sim/mesh/node_grid.hpp"

namespace hapbench {

/// A vertex on an edge of the grid, in 16 bytes instead of a position's 24: millions lie in memory beside the shell.
struct EdgeVertex {
  double along;        ///< the coordinate on the edge's axis [m]; the others are those of the node
  std::uint32_t node;  ///< where the edge starts in its layer, at (i, j): j * count(0) + i
  std::uint32_t layer : 30, axis : 2;
};

/// [m]
inline Vec3 position(const NodeGrid& grid, const EdgeVertex& vertex) {
  const auto row = static_cast<std::uint32_t>(grid.count(0));
  Vec3 p = grid.node(vertex.node % row, vertex.node / row, vertex.layer);
  p[vertex.axis] = vertex.along;
  return p;
}

/// The vertices in a layer of nodes and, before them, those on the edges that come to it from the layer below.
struct SurfaceLayer {
  std::vector<EdgeVertex> vertices;
  std::vector<Vec3> normals;  ///< as in IsoSurface
};

/// The part of a surface in some layers of cells. It has the vertices in its last layer of nodes only if it is the last
/// slab: else they are the first of the next one. Vertices are numbered through the layers, and on in the next slab.
struct SurfaceSlab {
  std::vector<SurfaceLayer> layers;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< numbered from this slab's first vertex, as are the cells
  CutCells cells;
};

/// The surface that marching_cubes returns, in slabs from the lowest z up, 16 at most whatever the number of threads.
/// `grid` is the field's.
std::vector<SurfaceSlab> surface_slabs(const DensityField& field, const NodeGrid& grid, KeptOfSurface kept);

}  // namespace hapbench
