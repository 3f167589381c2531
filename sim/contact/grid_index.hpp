#pragma once

#include <cstdint>
#include <vector>

#include "sim/core/aligned.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Cells of a uniform grid around points, 2.5 point spacings wide, the fastest size measured (0.25 mm for shells spaced
/// by 0.1 mm). Their number is at most a few times the number of points, whatever the extent.
class GridCells {
 public:
  /// Cells of the given edge [m], or larger ones if they would be too many.
  GridCells(const Box& bounds, std::size_t points, double edge);
  /// `spacing` of neighbouring points [m]; 0 if it is unknown.
  static GridCells for_spacing(const Box& bounds, std::size_t points, double spacing);

  struct Range {
    std::size_t first = 1, last = 0;
    bool empty() const { return first > last; }
  };
  /// The cells between two coordinates along an axis.
  Range range(double low, double high, int axis) const;
  /// Cell (i, j, k) has the number (i * count(1) + j) * count(2) + k. Points out of bounds are in the nearest cell.
  std::uint32_t cell_of(const Vec3& point) const;
  std::size_t count(std::size_t axis) const { return count_[axis]; }
  std::size_t count() const { return count_[0] * count_[1] * count_[2]; }
  /// Edge of a cell [m].
  double size() const { return size_; }

 private:
  double size_;
  Vec3 origin_;
  std::size_t count_[3];
};

/// The points of a shell sorted by the cells of a uniform grid, in compressed sparse rows. The points of the cells
/// (i, j, k0 … k1) are one contiguous range of a copy of the shell, so that a search in a box reads one run of memory
/// per column of cells.
class GridIndex {
 public:
  /// O(n).
  explicit GridIndex(const PointShell& shell);

  /// Calls `visit(first, last)` for each column of cells that meets the box, with the range of its points in the sorted
  /// arrays. Ranges ascend.
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

  /// Sorted copies of the coordinates, padded as the shell's, and the shell index of each.
  const double* x() const { return x_.data(); }
  const double* y() const { return y_.data(); }
  const double* z() const { return z_.data(); }
  const std::uint32_t* shell_indices() const { return shell_index_.data(); }
  /// True if sorting changed nothing, so that runs come in ascending shell index.
  bool keeps_order() const { return keeps_order_; }
  double cell_size() const { return cells_.size(); }
  /// Upper bound of the number of runs that for_each_run visits.
  std::size_t columns() const { return cells_.count(0) * cells_.count(1); }

 private:
  GridCells cells_;
  std::vector<std::uint32_t> start_;  ///< first point of each cell, one more at the end
  AlignedDoubles x_, y_, z_;
  std::vector<std::uint32_t> shell_index_;
  bool keeps_order_ = true;
};

/// Indices of the points in the order of the GridIndex of their shell. `cell_size` as for PointShell. O(n).
std::vector<std::uint32_t> grid_order(const std::vector<SurfacePoint>& points, double cell_size);
/// The points in that order: searches in a shell of them need not sort (GridIndex::keeps_order).
std::vector<SurfacePoint> in_grid_order(const std::vector<SurfacePoint>& points, double cell_size);

/// Upper bound of the number of shell points that can lie in the balls at once, wherever the balls are, for the
/// capacity of buffers: their number times the points in the fullest cube that holds such a ball, grid cells rounded
/// up; for the thesis's drill a sixth of the block's points. O(shell size).
std::size_t most_points_in(const PointShell& shell, const ToolShape::Cover& cover);

}  // namespace hapbench
