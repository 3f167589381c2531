#include "sim/geometry/grid_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace hapbench {
namespace {

/// Edge length of a cell, divided by the distance between neighbouring points.
constexpr double kSpacingsPerCell = 2.5;
/// Maximum number of cells per point, which bounds the memory. Most cells are empty, because shells are
/// surfaces.
constexpr double kCellsPerPoint = 8.0;
/// Number of cells that is always allowed, so that small shells get cells of the requested size.
constexpr double kMinCells = 4096.0;

/// Returns the distance between neighbours [m] that n points would have if they were spread evenly over the
/// faces of their box.
double even_spacing(const Box& bounds, std::size_t n) {
  const Vec3 extent = bounds.size();
  const double points = static_cast<double>(std::max<std::size_t>(1, n));
  const double area = 2.0 * (extent.x() * extent.y() + extent.y() * extent.z() + extent.z() * extent.x());
  return area > 0.0 ? std::sqrt(area / points) : extent.maxCoeff() / points;
}

/// Indices 0 … n - 1 of points, sorted by cell. Points of the same cell keep their order.
struct SortedByCell {
  std::vector<std::uint32_t> start;  ///< position of each cell's first point in `order`; the last entry is n
  std::vector<std::uint32_t> order;
};

/// Sorts the points by cell with a counting sort. `position(i)` returns the position of point i [m].
template <class Position>
SortedByCell sorted_by_cell(const GridCells& cells, std::size_t n, Position position) {
  SortedByCell sorted;
  sorted.start.assign(cells.count() + 1, 0);
  sorted.order.resize(n);
  // Count the points of each cell. The cells are computed twice instead of stored, to save memory for millions
  // of points.
  for (std::size_t i = 0; i < n; ++i) ++sorted.start[cells.cell_of(position(i))];
  // The partial sum of the counts up to a cell is the end of the cell's points. Filling each cell from its end moves
  // this end to the start of the cell.
  std::partial_sum(sorted.start.begin(), sorted.start.end(), sorted.start.begin());
  for (std::size_t i = n; i-- > 0;)
    sorted.order[--sorted.start[cells.cell_of(position(i))]] = static_cast<std::uint32_t>(i);
  return sorted;
}

/// Replaces each of `count` numbers by the sum of itself and the next `window` - 1 numbers, or fewer at the end. The
/// numbers are `stride` entries apart.
void sum_windows(std::uint32_t* first, std::size_t count, std::size_t stride, std::size_t window) {
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 1; k < window && i + k < count; ++k) first[i * stride] += first[(i + k) * stride];
  }
}

}  // namespace

GridCells GridCells::for_spacing(const Box& bounds, std::size_t points, double spacing) {
  return {bounds, points, kSpacingsPerCell * (spacing > 0.0 ? spacing : even_spacing(bounds, points))};
}

GridCells::GridCells(const Box& bounds, std::size_t points, double edge)
    : size_(edge > 0.0 ? edge : 1.0), origin_(bounds.min) {
  const Vec3 extent = bounds.size();
  const double number = static_cast<double>(std::max<std::size_t>(1, points));
  const auto cells = [&](int axis) { return std::floor(extent[axis] / size_) + 1.0; };
  while (cells(0) * cells(1) * cells(2) > std::max(kMinCells, kCellsPerPoint * number)) size_ *= 1.25;
  for (int axis = 0; axis < 3; ++axis) count_[axis] = static_cast<std::size_t>(cells(axis));
}

std::uint32_t GridCells::cell_of(const Vec3& point) const {
  std::size_t index = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = std::floor((point[axis] - origin_[axis]) / size_);
    const auto last = static_cast<double>(count_[axis] - 1);
    index = index * count_[axis] + static_cast<std::size_t>(std::clamp(along, 0.0, last));
  }
  return static_cast<std::uint32_t>(index);
}

GridCells::Range GridCells::range(double low, double high, int axis) const {
  // Uses the expression of cell_of, which is monotone in the coordinate. So a point in the box is never in a
  // cell outside the range.
  const double first = std::floor((low - origin_[axis]) / size_), last = std::floor((high - origin_[axis]) / size_);
  const auto end = static_cast<double>(count_[axis] - 1);
  if (!(last >= 0.0 && first <= end)) return {};
  return {static_cast<std::size_t>(std::max(first, 0.0)), static_cast<std::size_t>(std::min(last, end))};
}

GridIndex::GridIndex(const PointShell& shell)
    : cells_(GridCells::for_spacing(shell.bounds(), shell.size(), shell.cell_size())),
      x_(shell.padded_size(), PointShell::kFarAway),
      y_(shell.padded_size(), PointShell::kFarAway),
      z_(shell.padded_size(), PointShell::kFarAway) {
  SortedByCell sorted = sorted_by_cell(cells_, shell.size(),
                                       [&](std::size_t i) { return Vec3(shell.x()[i], shell.y()[i], shell.z()[i]); });
  start_ = std::move(sorted.start);
  shell_index_ = std::move(sorted.order);
  keeps_order_ = std::is_sorted(shell_index_.begin(), shell_index_.end());
  // Copy the coordinates in the order of the cells.
  for (std::size_t k = 0; k < shell.size(); ++k) {
    const std::uint32_t i = shell_index_[k];
    x_[k] = shell.x()[i];
    y_[k] = shell.y()[i];
    z_[k] = shell.z()[i];
  }
  shell_index_.resize(shell.padded_size());
}

std::vector<std::uint32_t> grid_order(const std::vector<SurfacePoint>& points, double cell_size) {
  const GridCells cells = GridCells::for_spacing(bounds_of(points), points.size(), cell_size);
  return sorted_by_cell(cells, points.size(), [&](std::size_t i) { return points[i].position; }).order;
}

std::vector<SurfacePoint> in_grid_order(const std::vector<SurfacePoint>& points, double cell_size) {
  std::vector<SurfacePoint> ordered;
  ordered.reserve(points.size());
  for (const std::uint32_t i : grid_order(points, cell_size)) ordered.push_back(points[i]);
  return ordered;
}

std::size_t max_points_in_cube(const PointShell& shell, double radius) {
  if (shell.size() == 0) return 0;
  // Count the points in cells slightly larger than the radius, so that an interval of one diameter meets
  // at most three cells.
  const GridCells cells(shell.bounds(), shell.size(), radius * (1.0 + 1e-6));
  const auto window = static_cast<std::size_t>(std::floor(2.0 * radius / cells.size())) + 2;
  std::vector<std::uint32_t> points(cells.count());
  for (std::size_t i = 0; i < shell.size(); ++i) ++points[cells.cell_of(shell.point(i).position)];
  // Sum the counts over cubes of `window` cells, along z, then y, then x.
  const std::size_t nx = cells.count(0), ny = cells.count(1), nz = cells.count(2);
  for (std::size_t column = 0; column < nx * ny; ++column) sum_windows(&points[column * nz], nz, 1, window);
  for (std::size_t i = 0; i < nx; ++i) {
    for (std::size_t k = 0; k < nz; ++k) sum_windows(&points[i * ny * nz + k], ny, nz, window);
  }
  for (std::size_t k = 0; k < ny * nz; ++k) sum_windows(&points[k], nx, ny * nz, window);
  return *std::max_element(points.begin(), points.end());
}

}  // namespace hapbench
