#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/tool/closed_surface.hpp"

namespace hapbench {

/// Finds the foremost of many points along any direction: the support function of their convex hull, exactly.
///
/// Directions are sorted into 6 x 16 x 16 cells of a cube. Let p be the point that is foremost along the middle c of a
/// cell of radius r. A point v is foremost along some unit direction u of the cell only if <c, p - v> <= r |v - p|,
/// which follows from <u, v - p> >= 0 and |u - c| <= r; each cell lists these points. A query visits the points of one
/// cell, a fraction of about 4 r^2 for a round body; building costs 1536 times the points, on oneTBB's threads.
class SupportTable {
 public:
  /// Precondition: there are points.
  explicit SupportTable(std::vector<Vec3> points);

  /// max <direction, p> over the points [m]; the direction need not be a unit vector.
  double support(const Vec3& direction) const noexcept;
  /// The place of the hull that is foremost along the unit direction; on a foremost edge or face, a place near the one
  /// nearest to `abreast`.
  Vec3 foremost(const Vec3& direction, const Vec3& abreast) const noexcept;

 private:
  std::vector<Vec3> points_;
  double tie_;  ///< points up to this far behind the foremost one count as foremost [m]
  std::vector<std::vector<std::uint32_t>> cells_;
};

/// A solid as the signed distance to its surface, negative inside, smooth between the nodes of a regular grid: the body
/// of a MeshTool, in the tool's own frame (tip centre at the origin, axis along -z).
///
/// The field is the mean of 27 nodes by the weights of a quadratic B-spline about the nearest one,
///
///     phi_h(x) = sum_k w_k(x) phi(x_k),   w >= 0,  sum w_k = 1,  sum w_k x_k = x,
///     sum w_k (x_k - x)^2 = h^2 / 4 an axis,
///
/// with phi exact at the nodes. A point beyond the grid, which contains the body, has the value of the nearest place in
/// the grid plus the distance to it. Tricubic interpolation would need 64 nodes, and its negative weights overshoot at
/// edges; these 27 give
/// - a continuous gradient (phi_h is C1), each component within [-1, 1];
/// - |phi_h - phi| <= sum w_k |x_k - x| <= sqrt(sum w_k |x_k - x|^2) = sqrt(3)/2 h, because phi is Lipschitz with
///   constant 1; so phi_h = 0 also lies within error_bound() of the mesh. Where the surface is smooth with principal
///   curvatures c the error is h^2/8 (c_1 + c_2) to leading order, on flats 0;
/// - phi_h >= phi for convex bodies, by Jensen's inequality: the body lies in the mesh, with edges rounded from within;
/// - phi_h between the smallest and the largest of its 27 nodes, so that most points need no evaluation (kinds()).
///
/// Immutable. Made by oneTBB's threads, with the same bytes for any number of them; a node takes O(log triangles).
class SignedDistanceGrid {
 public:
  /// The surface in the tool's frame [m]; `spacing` of the nodes [m]. Throws std::invalid_argument with measured values
  /// and advice if the surface encloses a node more than once (parts that overlap; not detected between nodes), more
  /// than a tenth of it is less than two spacings thick, or the nodes would take more than 1 GiB.
  SignedDistanceGrid(const ClosedSurface& surface, double spacing);

  /// The spacing that gives the bounding box of a mesh about 128^3 nodes with margins: 20 MB, some seconds at most.
  static double suggested_spacing(std::span<const Vec3> vertices);

  double spacing() const noexcept { return nodes_.spacing; }  ///< [m]
  /// sqrt(3)/2 spacing [m].
  double error_bound() const noexcept { return 0.5 * std::numbers::sqrt3 * nodes_.spacing; }
  /// A box that contains the body, in the tool's frame [m].
  const Box& box() const noexcept { return box_; }
  /// Depth of the deepest node: half the thickness of the body [m].
  double half_width() const noexcept { return half_width_; }
  double reach() const noexcept { return reach_; }  ///< of the body's furthest point from the origin [m]

  /// True if no vertex of the mesh lies in front of the plane of a triangle by more than 1 % of the spacing.
  bool convex() const noexcept { return convex_; }
  /// A large flat face of a convex body: <normal, x> <= offset for all of its points.
  struct Face {
    Vec3 normal;
    double offset;
  };
  std::span<const Face> flat_faces() const noexcept { return faces_; }
  /// The mesh's corners by direction.
  const SupportTable& hull() const noexcept { return hull_; }
  /// The mesh's vertices [m], each once.
  std::span<const Vec3> vertices() const noexcept { return vertices_; }

  // For kernels (sim/tool/mesh_tool.cpp).

  const GridNodes& nodes() const noexcept { return nodes_; }
  const double* values() const noexcept { return values_.data(); }  ///< phi of each node [m], and one more number
  /// Class of the points nearest to a node, as far as the 27 nodes around it determine it.
  enum Kind : std::uint8_t { outside = 0, inside = 1, mixed = 2 };
  const std::uint8_t* kinds() const noexcept { return kinds_.data(); }

 private:
  void fill(const ClosedSurface& surface, const TriangleTree& tree);
  void classify();
  void find_faces(const ClosedSurface& surface);

  GridNodes nodes_;
  Box box_;
  double reach_, half_width_ = 0.0;
  bool convex_ = false;
  std::vector<Vec3> vertices_;
  SupportTable hull_;
  std::vector<Face> faces_;
  std::vector<double> values_;
  std::vector<std::uint8_t> kinds_;
};

}  // namespace hapbench
