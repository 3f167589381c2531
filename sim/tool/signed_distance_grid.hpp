#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/tool/closed_surface.hpp"
#include "sim/tool/grid_nodes.hpp"
#include "sim/tool/support_table.hpp"

namespace hapbench {

/// A solid as the signed distance to its surface, negative inside, smooth between the nodes of a regular grid: the body
/// of a MeshTool, in the tool's own frame (tip centre at the origin, axis along -z).
///
/// The field is the mean of 27 nodes by the weights of a quadratic B-spline about the nearest one,
///
///     phi_h(x) = sum_k w_k(x) phi(x_k),   w >= 0,  sum w_k = 1,  sum w_k x_k = x,  sum w_k (x_k - x)^2 = h^2 / 4 an
///     axis,
///
/// with phi exact at the nodes; for points beyond the grid, where no body is, that of the nearest place in it, and the
/// way to there on top. Tricubic interpolation takes 64 nodes, and its negative weights overshoot at edges; these 27
/// give
/// - a gradient that is continuous (C1), each component within [-1, 1];
/// - |phi_h - phi| <= sum w_k |x_k - x| <= sqrt(sum w_k |x_k - x|^2) = sqrt(3)/2 h, since phi changes no faster than
///   the way (Lipschitz 1); so phi_h = 0 lies within error_bound() of the mesh, too. Where the surface is smooth with
///   principal curvatures c the error is h^2/8 (c_1 + c_2) to leading order, on flats 0;
/// - phi_h >= phi for convex bodies, by Jensen's inequality: their body lies in the mesh, edges are rounded from
///   within;
/// - phi_h between the smallest and the largest of its 27 nodes, so that most points need none of this (kind()).
///
/// Immutable; made once, by oneTBB's threads, the same bytes for any number of them. A node's exact distance takes
/// O(log triangles).
class SignedDistanceGrid {
 public:
  /// The triangles counter-clockwise from outside, in the tool's frame [m]; `spacing` of the nodes [m].
  ///
  /// Throws std::invalid_argument with what was measured and what to do when the mesh is no closed surface
  /// (ClosedSurface), a node lies in it more than once or inside out (parts that overlap; what happens between two
  /// nodes is not seen), more than a tenth of its surface is less than two spacings thick, or nodes take more than 1
  /// GiB.
  SignedDistanceGrid(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles, double spacing);

  /// The spacing that gives the bounding box of a mesh about 128^3 nodes, margins and all: 20 MB, some seconds at most.
  static double suggested_spacing(std::span<const Vec3> vertices);

  double spacing() const noexcept { return nodes_.spacing; }  ///< [m]
  /// sqrt(3)/2 spacing [m].
  double error_bound() const noexcept;
  /// Everything of the body lies between these corners, in the tool's frame [m].
  const Vec3& low() const noexcept { return low_; }
  const Vec3& high() const noexcept { return high_; }
  /// Depth of the deepest node: half of how thick the body is [m].
  double half_width() const noexcept { return half_width_; }
  double reach() const noexcept { return reach_; }    ///< of the body's furthest point from the origin [m]
  double volume() const noexcept { return volume_; }  ///< of the mesh [m^3]
  /// The share of the mesh's area where a way inwards of less than two spacings leads out again.
  double thin_share() const noexcept { return thin_share_; }
  std::size_t bytes() const noexcept;

  /// True when no vertex of the mesh lies before the plane of a triangle by more than 1 % of the spacing.
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

  // What kernels read (sim/tool/grid_spline.hpp).

  const GridNodes& nodes() const noexcept { return nodes_; }
  const double* values() const noexcept { return values_.data(); }  ///< phi of each node [m], and one number more
  /// What the 27 nodes around a node say about all points that it is nearest to.
  enum Kind : std::uint8_t { outside = 0, inside = 1, mixed = 2 };
  const std::uint8_t* kinds() const noexcept { return kinds_.data(); }

 private:
  SignedDistanceGrid(const ClosedSurface& surface, double spacing);
  void fill(const ClosedSurface& surface, const class TriangleTree& tree);
  void classify();
  void find_faces(const ClosedSurface& surface);

  GridNodes nodes_;
  Vec3 low_, high_;
  double reach_, volume_, half_width_ = 0.0, thin_share_ = 0.0;
  bool convex_ = false;
  std::vector<Vec3> vertices_;
  SupportTable hull_;
  std::vector<Face> faces_;
  std::vector<double> values_;
  std::vector<std::uint8_t> kinds_;
};

}  // namespace hapbench
