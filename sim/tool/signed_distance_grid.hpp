#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/tool/closed_surface.hpp"

namespace hapbench {

/// Support function of the convex hull of many points: finds the extreme point along any direction, exactly.
///
/// Directions are sorted into 6 x 16 x 16 cells on the faces of a cube. Let c be the direction in the middle of a
/// cell, r the largest distance |u - c| of a unit direction u in the cell, and p the extreme point along c. A point
/// v is extreme along some direction u of the cell only if <c, p - v> <= r |v - p|; this follows from <u, v - p> >=
/// 0 and |u - c| <= r. Each cell lists the points that satisfy this condition. A query evaluates only the points that
/// one cell lists. In a round body, a cell lists about a fraction 4 r^2 of all points. Construction evaluates every
/// point for each of the 1536 cells, on oneTBB's threads.
class SupportTable {
 public:
  /// Precondition: there is at least one point.
  explicit SupportTable(std::vector<Vec3> points);

  /// Returns the support function max <direction, p> over the points [m]. The direction need not be a unit vector.
  double support(const Vec3& direction) const noexcept;
  /// Returns the support point of the hull along the unit direction. If a whole edge or face is extreme, returns one of
  /// its points, approximately the point closest to `near`.
  Vec3 foremost(const Vec3& direction, const Vec3& near) const noexcept;

 private:
  std::vector<Vec3> points_;
  double tie_;  ///< points within this distance behind the extreme point also count as extreme [m]
  std::vector<std::vector<std::uint32_t>> cells_;
};

/// Body of a MeshTool: the signed distance to its surface, negative inside, interpolated smoothly between the nodes
/// of a regular grid. All coordinates are in the tool frame (tip centre at the origin, axis along -z).
///
/// The interpolated field phi_h is a weighted mean of the 27 nodes x_k around the nearest node, with the weights
/// w_k of a quadratic B-spline. phi is the exact signed distance and h the grid spacing:
///
///     phi_h(x) = sum_k w_k(x) phi(x_k),   w_k >= 0,  sum w_k = 1,  sum w_k x_k = x,
///     sum w_k (x_k - x)^2 = h^2 / 4 along each axis.
///
/// The grid contains the body. A point outside of the grid has the value of the closest point of the grid plus the
/// distance to that point. Tricubic interpolation would need 64 nodes, and its negative weights would overshoot at
/// edges. The quadratic B-spline has these properties:
/// - The gradient is continuous (phi_h is C1), with each component in [-1, 1].
/// - |phi_h - phi| <= sum w_k |x_k - x| <= sqrt(sum w_k |x_k - x|^2) = sqrt(3)/2 h, because phi is Lipschitz
/// continuous with constant 1. Hence the surface phi_h = 0 also lies within error_bound() of the mesh. Where the
/// mesh is smooth with principal curvatures c_1 and c_2, the error is h^2/8 (c_1 + c_2) to leading order; on flat
/// faces it is 0.
/// - phi_h >= phi for convex bodies, by Jensen's inequality: the body lies inside the mesh, with edges rounded off.
/// - phi_h lies between the smallest and the largest value of its 27 nodes. Therefore kinds() tells for most points
/// whether they are inside, without an evaluation of phi_h.
///
/// Immutable. Computed on oneTBB's threads; the result does not depend on the number of threads. For a mesh of n
/// triangles, computing the value of a node takes O(log n) time.
class SignedDistanceGrid {
 public:
  /// `surface`: in the tool frame [m]; `spacing`: distance between neighbouring nodes [m]. Throws std::invalid_argument
  /// with the measured values and advice in three cases:
  /// - The winding number at a node is neither 0 nor 1 because parts overlap. Overlaps between nodes are not detected.
  /// - On more than a tenth of its surface, the body is less than two spacings thick, measured along the inward normal.
  /// - The nodes would take more than 1 GiB.
  SignedDistanceGrid(const ClosedSurface& surface, double spacing);

  /// Returns the spacing [m] at which the grid around a mesh has about 128^3 nodes, including the nodes in the margins
  /// around the mesh. Such a grid takes 20 MB of memory and is computed in a few seconds at most.
  static double suggested_spacing(std::span<const Vec3> vertices);

  double spacing() const noexcept { return nodes_.spacing; }  ///< [m]
  /// Returns an upper bound of |phi_h - phi| [m]: sqrt(3)/2 times the spacing.
  double error_bound() const noexcept { return 0.5 * std::numbers::sqrt3 * nodes_.spacing; }
  /// Box that contains the body, in the tool frame [m].
  const Box& box() const noexcept { return box_; }
  /// Depth of the deepest node [m], which is half the thickness of the body.
  double half_width() const noexcept { return half_width_; }
  /// Distance from the tip centre to the farthest point of the body [m].
  double reach() const noexcept { return reach_; }

  /// Returns true if no vertex of the mesh lies in front of the plane of a triangle by more than 1 % of the
  /// spacing.
  bool convex() const noexcept { return convex_; }
  /// Large flat face of a convex body: <normal, x> <= offset [m] for all points x of the body.
  struct Face {
    Vec3 normal;
    double offset;
  };
  std::span<const Face> flat_faces() const noexcept { return faces_; }
  /// Support function of the mesh's convex hull.
  const SupportTable& hull() const noexcept { return hull_; }
  /// Vertices of the mesh [m], without duplicates.
  std::span<const Vec3> vertices() const noexcept { return vertices_; }

  // Raw arrays for the SIMD loops in sim/tool/mesh_tool.cpp.

  const GridNodes& nodes() const noexcept { return nodes_; }
  const double* values() const noexcept { return values_.data(); }  ///< phi at each node [m], then one padding number
  /// Class of all points whose nearest node is a given node: all outside or all inside the body. `mixed`: the 27 nodes
  /// around the given node do not determine the class, so each point must be evaluated.
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
