#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sim/geometry/analytic_shells.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Scalar field whose iso surface marching_cubes() extracts.
enum class Density {
  signed_distance,  ///< minus the signed distance [m], iso value 0
  /// 1 inside and 0 outside, iso value 0.5: the "raw density field" of thesis section 2.1, taken literally.
  binary
};

/// A solid and the grid on which it is sampled. The grid nodes lie at half-integer multiples of the spacing.
struct DensityField {
  std::function<double(const Vec3&)> signed_distance;  ///< negative inside [m]; called by several threads
  Vec3 min = Vec3::Zero();                             ///< smallest corner of a box that contains the solid [m]
  /// Largest corner of the same box [m].
  Vec3 max = Vec3::Zero();
  double spacing = 0.0001;  ///< [m], > 0
  Density density = Density::signed_distance;
};

/// Grid cells that the surface cuts, and the vertices on the edges of each cell. A vertex belongs to all cells
/// around its edge, at most four. Section 2.1 of the thesis stores points in this form: "up to 4 points contained by a
/// single grid cell".
struct CutCells {
  std::vector<Vec3> centres;  ///< centres of the cells [m]
  /// Index in `vertices` at which each cell begins; the last entry is vertices.size().
  std::vector<std::uint32_t> starts = {0};
  std::vector<std::uint32_t> vertices;  ///< vertex numbers, ordered by cell and within a cell by edge
};

/// Surface of a solid as triangles with shared vertices.
struct IsoSurface {
  /// Vertices [m] with outward normals. A normal is the normalised, unweighted mean of the unit normals of the
  /// adjacent triangles (thesis section C.1); zero if no adjacent triangle has an area.
  std::vector<SurfacePoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
  CutCells cells;
};

/// Selects which parts of an IsoSurface are computed in addition to the vertices.
struct IsoSurfaceOptions {
  bool triangles = false;
  bool cells = false;
};

/// Returns the surface of the solid by marching cubes with linear interpolation along the grid edges. The surface
/// is closed and manifold. On an ambiguous face of a cell the inside corners are separated, identically for both
/// cells of the face.
///
/// Evaluates the field only near the surface: skips a square of nodes in a layer if the distance at its middle shows
/// that all its nodes are inside or all are outside. Time and memory are proportional to the area of the surface, with
/// two exceptions: the memory for a few layers of the grid, and the time for a few operations for every 64 nodes. A
/// vertex takes 48 bytes in the result. During the computation, it also takes 48 bytes in the array of its slab (a
/// range of grid layers). This array is released as soon as it has been copied to the result. Runs on oneTBB's threads;
/// the result does not depend on their number.
IsoSurface marching_cubes(const DensityField& field, IsoSurfaceOptions options = {});

/// Returns the density field of the block for marching_cubes(). `spacing`: distance between neighbouring grid nodes
/// [m]. Precondition: spacing > 0.
DensityField density_field(const BlockWithHole& block, double spacing, Density density);

/// Returns the vertices of marching_cubes() as a shell in the order of its grid (in_grid_order). Omits vertices whose
/// normal is zero. O(vertices). A point takes 48 bytes in the shell; construction temporarily needs about twice
/// this memory.
PointShell surface_shell(const DensityField& field);

/// Returns the vertices of a surface as the thesis stores them (sections 2.1 and C.2): each vertex is repeated for each
/// cell that has the vertex on an edge, four times on average, so that each point belongs to one cell. Cells are in the
/// order of grid_order(), the points of a cell in the order of its edges. Omits vertices whose normal is zero.
/// `spacing`: distance between neighbouring grid nodes [m]. O(vertices). Precondition: the surface was computed with
/// its cells (IsoSurfaceOptions::cells).
ShellPoints points_by_cell(const IsoSurface& surface, double spacing);

/// Triangle of a marching cubes case: the numbers of the cell edges on which its corners lie, counter-clockwise seen
/// from outside. The cases are derived instead of copied from a table. The bits of the number c of a cell corner are
/// the coordinates of the corner (bit 0: x, bit 1: y, bit 2: z). Cell edge number 3 c + axis starts at corner c, whose
/// bit `axis` is 0, and runs along that axis.
using CubeTriangle = std::array<int, 3>;

/// Returns the triangles of the case in which bit c of `inside` is set if corner c is inside. Neighbouring cells
/// agree about their common face in every case.
std::vector<CubeTriangle> cube_triangles(unsigned inside);

}  // namespace hapbench
