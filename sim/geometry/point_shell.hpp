#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/core/aligned.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

class GridIndex;

/// Point on the surface of an environment object: position [m] and outward unit normal, world frame.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();
  Vec3 normal = {0.0, 0.0, 1.0};
};

/// Returns the bounding box of the points; a box of zero size at the origin if there are no points.
Box bounds_of(const std::vector<SurfacePoint>& points);

/// Points of a shell, and the grid cell to which each point belongs.
struct ShellPoints {
  std::vector<SurfacePoint> points;
  /// Cell number of each point. The numbers start at 0 and increase in the order in which the cells first appear. Empty
  /// if the cells follow from the positions (see PointShell::cell_of_points).
  std::vector<std::uint32_t> cells;
};

/// Positions [m] and normals of points, one array per coordinate, each padded to whole packs (simd::padded).
struct ShellColumns {
  /// Coordinate of padding points [m], farther away than any tool reaches. Finite, because infinite coordinates
  /// would produce NaN.
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

/// The environment object as points with normals, in the memory layout of the contact search: one array per
/// coordinate, aligned to 64 bytes. Each array is padded to whole packs with points far outside any scene, so that
/// loops need no special case for the last points.
class PointShell {
 public:
  static constexpr double kFarAway = ShellColumns::kFarAway;  ///< coordinate of padding points [m]

  /// `cell_size`: edge length [m] of the grid cells in which the local average merges points; 0 if there is no
  /// grid. `cells`: see ShellPoints::cells.
  PointShell(const std::vector<SurfacePoint>& points, double cell_size, std::vector<std::uint32_t> cells = {});
  /// A copy has the same points and shares the grid. There is no assignment, because searches refer to the grid.
  PointShell(const PointShell&) = default;
  PointShell& operator=(const PointShell&) = delete;

  std::size_t size() const { return size_; }
  std::size_t padded_size() const { return columns_.x.size(); }
  double cell_size() const { return cell_size_; }
  /// Bounding box of all points; a box of zero size at the origin if there are no points.
  const Box& bounds() const { return bounds_; }

  const double* x() const { return columns_.x.data(); }
  const double* y() const { return columns_.y.data(); }
  const double* z() const { return columns_.z.data(); }
  const double* nx() const { return columns_.nx.data(); }
  const double* ny() const { return columns_.ny.data(); }
  const double* nz() const { return columns_.nz.data(); }

  SurfacePoint point(std::size_t i) const { return {{x()[i], y()[i], z()[i]}, {nx()[i], ny()[i], nz()[i]}}; }
  std::vector<SurfacePoint> points() const;

  /// Returns the cell number of each point, from 0 in the order in which the cells first appear. If the shell was
  /// created with cells, returns these cells. Otherwise the cells are the cubes between half-integer multiples of
  /// cell_size, so that points at integer multiples of cell_size have one cell each. O(size log size): call it before a
  /// run, not in a step.
  std::vector<std::uint32_t> cell_of_points() const;

  /// Returns the points sorted by the cells of a grid (grid_index.hpp), for contact searches. The first call builds it,
  /// O(size). Later calls, also those of copies of this shell, return the same grid. It exists as long as this shell or
  /// a copy of it. Thread-safe.
  const GridIndex& grid() const;
  /// Returns an upper bound of the number of points in a ball, wherever the ball is. `radius` > 0 [m], finite. The
  /// first call with a radius is O(size); later calls return the same number. Thread-safe.
  std::size_t max_points_in_ball(double radius) const;

 private:
  struct SearchData;

  std::size_t size_;
  double cell_size_;
  Box bounds_;
  ShellColumns columns_;
  std::vector<std::uint32_t> cells_;
  std::shared_ptr<SearchData> search_data_;  ///< filled by the first calls that need it, and shared by copies
};

}  // namespace hapbench
