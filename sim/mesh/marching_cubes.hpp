#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sim/mesh/density.hpp"
#include "sim/mesh/half_edge_mesh.hpp"

namespace hapbench {

/// A solid sampled on a grid whose nodes lie at half-integer multiples of the spacing.
struct DensityField {
  std::function<double(const Vec3&)> signed_distance;  ///< exact, negative inside [m]
  Vec3 min = Vec3::Zero();                             ///< a box that holds the solid [m]
  Vec3 max = Vec3::Zero();
  double spacing = 0.0001;  ///< [m], > 0
  Density density = Density::signed_distance;
};

/// The cells of the grid that the surface cuts, and the vertices on the edges of each: a vertex belongs to all of the
/// up to four cells around its edge. Thesis 2.1 keeps its points so: "up to 4 points contained by a single grid cell".
struct CutCells {
  std::vector<Vec3> centres;                ///< [m]
  std::vector<std::uint32_t> starts = {0};  ///< where each cell's vertices start, one more at the end
  std::vector<std::uint32_t> vertices;      ///< their numbers in the mesh, by cell and, in a cell, by edge
};

/// Number of grid cells the box has, as a double because absurd ones are to be refused.
double cell_count(const DensityField& field);

/// The surface of the solid by marching cubes with linear interpolation along the edges and shared vertices: closed and
/// manifold. Evaluates the field near the surface only: a block of cells further from it than its half diagonal is
/// skipped whole, so the cost grows with the surface and not with the volume. Where a cell's face is ambiguous the
/// inside corners are separated, on both sides of the face alike. Adds the cells it cuts to `cells`, if any are asked
/// for. Throws std::runtime_error if a face cannot be added, which would mean that the surface is not manifold.
HalfEdgeMesh marching_cubes(const DensityField& field, CutCells* cells = nullptr);

}  // namespace hapbench
