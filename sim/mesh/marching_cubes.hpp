#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sim/geometry/analytic_shells.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// The values at the nodes of a density grid.
enum class Density {
  signed_distance,  ///< minus the signed distance, iso value 0
  binary            ///< 1 inside and 0 outside, iso value 0.5: the "raw density field" of thesis 2.1 taken literally
};

/// A solid sampled on a grid whose nodes lie at half-integer multiples of the spacing.
struct DensityField {
  std::function<double(const Vec3&)> signed_distance;  ///< exact, negative inside [m]; called by several threads
  Vec3 min = Vec3::Zero();                             ///< corners of a box that contains the solid [m]
  Vec3 max = Vec3::Zero();
  double spacing = 0.0001;  ///< [m], > 0
  Density density = Density::signed_distance;
};

/// The cells of the grid that the surface cuts, each with the vertices on its edges; a vertex belongs to all of the up
/// to four cells around its edge. Thesis 2.1 stores points this way: "up to 4 points contained by a single grid cell".
struct CutCells {
  std::vector<Vec3> centres;                ///< [m]
  std::vector<std::uint32_t> starts = {0};  ///< where each cell begins in `vertices`, and the end
  std::vector<std::uint32_t> vertices;      ///< numbers of the vertices, by cell and, in a cell, by edge
};

/// The surface of a solid as triangles with shared vertices.
struct IsoSurface {
  /// With outward normals: the normalised, unweighted mean of the unit normals of the adjacent triangles (thesis C.1).
  /// The normal is zero where no adjacent triangle has an area.
  std::vector<SurfacePoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside
  CutCells cells;
};

/// Parts of an IsoSurface to keep besides its vertices.
struct KeptOfSurface {
  bool triangles = false;
  bool cells = false;
};

/// The surface of the solid by marching cubes with linear interpolation along the edges of the grid: closed and
/// manifold. On an ambiguous face of a cell the inside corners are separated, identically from both sides.
///
/// Evaluates the field near the surface only: skips squares of nodes in a layer that are all inside or all outside by
/// the distance at their middle. Cost and memory grow with the surface, apart from a few layers of the grid and a few
/// operations for every 64 nodes. A vertex takes 48 bytes, first in a slab of the grid, whose arrays grow, then in
/// the result. Runs on oneTBB's threads; the result does not depend on their number.
IsoSurface marching_cubes(const DensityField& field, KeptOfSurface kept = {});

/// The block as a density field for marching cubes, with the spacing of its grid [m], > 0.
DensityField density_field(const BlockWithHole& block, double spacing, Density density);

/// The vertices of marching_cubes, without those that have no normal, as a shell in the order of its grid
/// (in_grid_order). O(vertices). A point takes 48 bytes in the shell and, while that is made, as many again and a few
/// for the order.
PointShell surface_shell(const DensityField& field);

/// The vertices of a surface as the thesis stores them (2.1, C.2): repeated for each cell that has them on an edge,
/// four times on average, so that each point belongs to one cell. Cells come in the order of grid_order, the points of
/// a cell in that of its edges. Omits vertices without a normal. `spacing` of the grid [m]. O(vertices). Precondition:
/// the surface was made with its cells.
ShellPoints points_by_cell(const IsoSurface& surface, double spacing);

/// A triangle of marching cubes, derived instead of copied from a table. The bits of a cell's corner c are its
/// coordinates (bit 0: x, bit 1: y, bit 2: z); edge 3 c + axis starts at corner c, whose bit `axis` is 0, and runs
/// along that axis.
using CubeTriangle = std::array<int, 3>;  ///< edges, counter-clockwise from outside

/// The triangles of the case in which bit c of `inside` is set if corner c is inside. Neighbouring cells agree about
/// their common face in all cases.
std::vector<CubeTriangle> cube_triangles(unsigned inside);

}  // namespace hapbench
