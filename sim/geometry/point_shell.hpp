#pragma once

#include <cstdint>
#include <vector>

#include "sim/core/aligned.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// A point of an environment object's surface: position [m] and unit outward normal, world frame.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();
  Vec3 normal = {0.0, 0.0, 1.0};
};

/// The bounding box of the points; zero at the origin if there are none.
Box bounds_of(const std::vector<SurfacePoint>& points);

/// The points of a shell and the grid cells that list them.
struct ShellPoints {
  std::vector<SurfacePoint> points;
  /// Number of each point's grid cell, 0 … cells - 1 in order of first appearance; empty if the cells follow from the
  /// positions.
  std::vector<std::uint32_t> cells;
};

/// Coordinates and normals of points, each column padded to whole packs (simd::padded).
struct ShellColumns {
  /// Coordinate of points that are not set [m], beyond every tool; finite, because infinities would produce NaN.
  static constexpr double kFarAway = 1e9;

  AlignedDoubles x, y, z, nx, ny, nz;

  explicit ShellColumns(std::size_t points)
      : x(simd::padded(points), kFarAway), y(x), z(x), nx(x.size()), ny(nx), nz(nx) {}
  void set(std::size_t i, const Vec3& position, const Vec3& normal) {
    x[i] = position.x();
    y[i] = position.y();
    z[i] = position.z();
    nx[i] = normal.x();
    ny[i] = normal.y();
    nz[i] = normal.z();
  }
};

/// The environment object as points with normals, laid out for the contact search: one array per coordinate, 64-byte
/// aligned and padded to whole packs with points far outside any scene, so that no loop needs a tail.
class PointShell {
 public:
  static constexpr double kFarAway = ShellColumns::kFarAway;  ///< coordinate of the padding points [m]

  /// cell_size is the edge [m] of the grid cells in which the local average merges points; 0 without a grid.
  /// `cells` is as in ShellPoints.
  PointShell(const std::vector<SurfacePoint>& points, double cell_size, std::vector<std::uint32_t> cells = {});

  std::size_t size() const { return size_; }
  std::size_t padded_size() const { return columns_.x.size(); }
  double cell_size() const { return cell_size_; }
  /// The box of all points; zero at the origin if there are none.
  const Box& bounds() const { return bounds_; }

  const double* x() const { return columns_.x.data(); }
  const double* y() const { return columns_.y.data(); }
  const double* z() const { return columns_.z.data(); }
  const double* nx() const { return columns_.nx.data(); }
  const double* ny() const { return columns_.ny.data(); }
  const double* nz() const { return columns_.nz.data(); }

  SurfacePoint point(std::size_t i) const { return {{x()[i], y()[i], z()[i]}, {nx()[i], ny()[i], nz()[i]}}; }
  std::vector<SurfacePoint> points() const;

  /// Number of each point's grid cell, 0 … cells - 1 in order of first appearance. The cells are those the shell was
  /// made with, or else the cubes between half-integer multiples of cell_size: a shell spaced by cell_size from the
  /// origin has one point in each. O(size log size); call it in preparation, not in a step.
  std::vector<std::uint32_t> cell_of_points() const;

 private:
  std::size_t size_;
  double cell_size_;
  Box bounds_;
  ShellColumns columns_;
  std::vector<std::uint32_t> cells_;
};

}  // namespace hapbench
