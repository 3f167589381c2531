#pragma once

#include <cstdint>
#include <vector>

#include "sim/core/aligned.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Uniform grid of cubic cells around points. for_spacing() makes the cells 2.5 point spacings wide, the fastest size
/// measured (0.25 mm for a shell with 0.1 mm spacing). The number of cells is at most 4096 or 8 times the number of
/// points, whichever is larger; if this limit would be exceeded, the cells are made larger.
class GridCells {
 public:
  /// Creates cells with edges of length `edge` [m], or longer edges if there would be too many cells.
  GridCells(const Box& bounds, std::size_t points, double edge);
  /// Returns the cells for points whose neighbours are `spacing` [m] apart. With `spacing` 0, the spacing is unknown
  /// and is estimated from the bounds and the number of points.
  static GridCells for_spacing(const Box& bounds, std::size_t points, double spacing);

  /// Cell numbers first … last along one axis; empty if first > last.
  struct Range {
    std::size_t first = 1, last = 0;
    bool empty() const { return first > last; }
  };
  /// Returns the numbers, along an axis, of the cells that overlap the interval from `low` to `high` [m] of this axis.
  Range range(double low, double high, int axis) const;
  /// Returns the number of the cell that contains a point. Cell (i, j, k) has the number (i * count(1) + j) *
  /// count(2) + k. A point outside the bounds belongs to the nearest cell.
  std::uint32_t cell_of(const Vec3& point) const;
  /// Number of cells along an axis.
  std::size_t count(std::size_t axis) const { return count_[axis]; }
  /// Number of all cells.
  std::size_t count() const { return count_[0] * count_[1] * count_[2]; }
  /// Edge length of a cell [m].
  double size() const { return size_; }

 private:
  double size_;
  Vec3 origin_;
  std::size_t count_[3];
};

/// The points of a shell, sorted by the cells of a uniform grid and stored in compressed sparse row form. The
/// points of the cells (i, j, k0 … k1) are contiguous in the sorted copy. A search in a box therefore reads one
/// contiguous range of memory per column of cells, where a column is all cells with the same i and j.
class GridIndex {
 public:
  /// Sorts the points. O(n).
  explicit GridIndex(const PointShell& shell);

  /// Calls `visit(first, last)` for each column of cells that meets the box, where first … last - 1 are
  /// positions in the sorted arrays. The ranges ascend.
  template <class Visit>
  void for_each_run(const Box& box, Visit visit) const {
    const GridCells::Range x = cells_.range(box.min.x(), box.max.x(), 0), y = cells_.range(box.min.y(), box.max.y(), 1);
    const GridCells::Range z = cells_.range(box.min.z(), box.max.z(), 2);
    if (x.empty() || y.empty() || z.empty()) return;
    for (std::size_t i = x.first; i <= x.last; ++i) {
      for (std::size_t j = y.first; j <= y.last; ++j) {
        const std::size_t column = (i * cells_.count(1) + j) * cells_.count(2);
        const std::uint32_t first = start_[column + z.first], last = start_[column + z.last + 1];
        if (first != last) visit(first, last);
      }
    }
  }

  /// Sorted copies of the coordinates, padded like the shell, and the shell index of each sorted point.
  const double* x() const { return x_.data(); }
  const double* y() const { return y_.data(); }
  const double* z() const { return z_.data(); }
  const std::uint32_t* shell_indices() const { return shell_index_.data(); }
  /// Returns true if the shell was already sorted by cell, so that for_each_run visits points in ascending
  /// shell index.
  bool keeps_order() const { return keeps_order_; }
  double cell_size() const { return cells_.size(); }
  /// Upper bound of the number of ranges that for_each_run visits.
  std::size_t columns() const { return cells_.count(0) * cells_.count(1); }

 private:
  GridCells cells_;
  /// Position of each cell's first point in the sorted arrays; the last entry is the number of points.
  std::vector<std::uint32_t> start_;
  AlignedDoubles x_, y_, z_;
  std::vector<std::uint32_t> shell_index_;
  bool keeps_order_ = true;
};

/// Returns the indices of the points, in the order in which a GridIndex would sort a PointShell with these points and
/// this `cell_size` [m]. O(n).
std::vector<std::uint32_t> grid_order(const std::vector<SurfacePoint>& points, double cell_size);
/// Returns the points in the order of grid_order(). A search in a shell with this order need not sort its points
/// (GridIndex::keeps_order).
std::vector<SurfacePoint> in_grid_order(const std::vector<SurfacePoint>& points, double cell_size);

/// Returns the largest number of shell points in a cube of grid cells that is large enough for a ball with this radius
/// [m], wherever the ball is. O(shell size). PointShell::max_points_in_ball() remembers the result.
std::size_t max_points_in_cube(const PointShell& shell, double radius);

}  // namespace hapbench
