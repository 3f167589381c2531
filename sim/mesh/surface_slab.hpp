#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {

/// A triangle of marching cubes, derived instead of copied from a table. The bits of a cell's corner c are its
/// coordinates (bit 0: x, bit 1: y, bit 2: z); edge 3 c + axis starts at corner c, whose bit `axis` is 0, and runs
/// along that axis.
using CubeTriangle = std::array<int, 3>;  ///< edges, counter-clockwise from outside

/// The triangles of the case in which bit c of `inside` is set if corner c is inside. Neighbouring cells agree about
/// their common face in all cases.
const std::vector<CubeTriangle>& cube_triangles(unsigned inside);

/// The nodes around the box of a density field, numbered from 0 along each axis; cells lie between them. Lengths in m.
class NodeGrid {
 public:
  explicit NodeGrid(const DensityField& field);

  std::size_t count(std::size_t axis) const { return count_[axis]; }
  double spacing() const { return spacing_; }
  double coordinate(std::size_t i, std::size_t axis) const {
    return spacing_ * (static_cast<double>(first_[axis] + static_cast<std::int64_t>(i)) - 0.5);
  }
  Vec3 node(std::size_t i, std::size_t j, std::size_t k) const {
    return {coordinate(i, 0), coordinate(j, 1), coordinate(k, 2)};
  }

 private:
  double spacing_;
  std::array<std::int64_t, 3> first_;  ///< first node, in spacings from the node at -1/2
  std::array<std::size_t, 3> count_;
};

/// A vertex on an edge of the grid, in 16 bytes instead of a position's 24, because there are millions of them.
struct EdgeVertex {
  double along;        ///< coordinate along the edge's axis [m]; the others are those of the node
  std::uint32_t node;  ///< the node (i, j) of the layer where the edge starts: j * count(0) + i
  std::uint32_t layer : 30, axis : 2;
};

inline Vec3 position(const NodeGrid& grid, const EdgeVertex& vertex) {
  const auto row = static_cast<std::uint32_t>(grid.count(0));
  Vec3 p = grid.node(vertex.node % row, vertex.node / row, vertex.layer);
  p[vertex.axis] = vertex.along;
  return p;
}

/// The vertices on the edges from the layer of nodes below to this one, followed by those in this layer.
struct SurfaceLayer {
  std::vector<EdgeVertex> vertices;
  std::vector<Vec3> normals;  ///< as in IsoSurface
};

/// The part of a surface in consecutive layers of cells. The vertices in its last layer of nodes belong to the next
/// slab, if there is one, as its first. Vertices are numbered layer by layer, continued in the next slab.
struct SurfaceSlab {
  std::vector<SurfaceLayer> layers;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< numbered from this slab's first vertex, as are the cells
  CutCells cells;
};

/// The surface that marching_cubes returns, in slabs from the lowest z up, at most 16 for any number of threads. `grid`
/// is the field's.
std::vector<SurfaceSlab> surface_slabs(const DensityField& field, const NodeGrid& grid, KeptOfSurface kept);

}  // namespace hapbench
