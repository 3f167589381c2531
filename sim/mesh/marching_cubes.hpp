#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/mesh/density.hpp"

namespace hapbench {

/// A solid sampled on a grid whose nodes lie at half-integer multiples of the spacing.
struct DensityField {
  std::function<double(const Vec3&)> signed_distance;  ///< exact, negative inside [m]; called by several threads
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
  std::vector<std::uint32_t> vertices;      ///< their numbers, by cell and, in a cell, by edge
};

/// The surface of a solid as triangles with shared vertices.
struct IsoSurface {
  /// With outward normals: the normalised, unweighted mean of the unit normals of the adjacent triangles (thesis C.1).
  /// The normal is zero where no adjacent triangle has an area.
  std::vector<SurfacePoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside
  CutCells cells;
};

/// What of a surface is kept beside its vertices.
struct KeptOfSurface {
  bool triangles = false;
  bool cells = false;
};

/// The surface of the solid by marching cubes with linear interpolation along the edges of the grid: closed and
/// manifold. Where a cell's face is ambiguous the inside corners are separated, on both sides of the face alike.
///
/// Evaluates the field near the surface only: squares of nodes in a layer that the distance at their middle shows to be
/// all inside or all outside are not looked into. Cost and memory grow with the surface (some 100 ns and, beside the
/// result, 40 bytes a vertex), but for a few layers of the grid and a few operations for every 64 nodes. Layers are
/// shared out among the threads that oneTBB gives; the result does not depend on their number.
IsoSurface marching_cubes(const DensityField& field, KeptOfSurface kept = {});

}  // namespace hapbench
