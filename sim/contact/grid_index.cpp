#include "sim/contact/grid_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace hapbench {
namespace {

/// Edge of a cell in distances of neighbouring points.
constexpr double kSpacingsPerCell = 2.5;
/// Cells per point at most; shells are surfaces, so most cells of their box are empty anyway.
constexpr double kCellsPerPoint = 8.0;
constexpr double kFewestCells = 4096.0;

/// Distance of neighbours if the points were spread evenly over the faces of their box.
double even_spacing(const Box& bounds, std::size_t n) {
  const Vec3 extent = bounds.max - bounds.min;
  const double points = static_cast<double>(std::max<std::size_t>(1, n));
  const double area = 2.0 * (extent.x() * extent.y() + extent.y() * extent.z() + extent.z() * extent.x());
  return area > 0.0 ? std::sqrt(area / points) : extent.maxCoeff() / points;
}

/// Numbers 0 … n - 1 of points sorted by cell; those of a cell keep their order.
struct SortedByCell {
  std::vector<std::uint32_t> start;  ///< first place of each cell, one more at the end
  std::vector<std::uint32_t> order;
};

/// Counting sort. `position(i)` is that of point i.
template <class Position>
SortedByCell sorted_by_cell(const GridCells& cells, std::size_t n, Position position) {
  SortedByCell sorted;
  sorted.start.assign(cells.count() + 1, 0);
  sorted.order.resize(n);
  // Cells are found twice instead of kept: millions of points have no memory to spare.
  for (std::size_t i = 0; i < n; ++i) ++sorted.start[cells.cell_of(position(i))];
  // Each cell's end; taking places from the back leaves its start.
  std::partial_sum(sorted.start.begin(), sorted.start.end(), sorted.start.begin());
  for (std::size_t i = n; i-- > 0;)
    sorted.order[--sorted.start[cells.cell_of(position(i))]] = static_cast<std::uint32_t>(i);
  return sorted;
}

}  // namespace

GridCells::GridCells(const Box& bounds, std::size_t points, double spacing)
    : GridCells(bounds, points, Edge{kSpacingsPerCell * (spacing > 0.0 ? spacing : even_spacing(bounds, points))}) {}

GridCells GridCells::of_edge(const Box& bounds, std::size_t points, double edge) {
  return {bounds, points, Edge{edge}};
}

GridCells::GridCells(const Box& bounds, std::size_t points, Edge edge)
    : size_(edge.edge > 0.0 ? edge.edge : 1.0), origin_(bounds.min) {
  const Vec3 extent = bounds.max - bounds.min;
  const double number = static_cast<double>(std::max<std::size_t>(1, points));
  const auto cells = [&](int axis) { return std::floor(extent[axis] / size_) + 1.0; };
  while (cells(0) * cells(1) * cells(2) > std::max(kFewestCells, kCellsPerPoint * number)) size_ *= 1.25;
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
  // The same expression as cell_of, which is monotone in the coordinate: no point in the box can be in a cell outside.
  const double first = std::floor((low - origin_[axis]) / size_), last = std::floor((high - origin_[axis]) / size_);
  const auto end = static_cast<double>(count_[axis] - 1);
  if (!(last >= 0.0 && first <= end)) return {};
  return {static_cast<std::size_t>(std::max(first, 0.0)), static_cast<std::size_t>(std::min(last, end))};
}

GridIndex::GridIndex(const PointShell& shell)
    : bounds_(shell.bounds()),
      cells_(bounds_, shell.size(), shell.cell_size()),
      x_(shell.padded_size(), PointShell::kFarAway),
      y_(shell.padded_size(), PointShell::kFarAway),
      z_(shell.padded_size(), PointShell::kFarAway),
      shell_size_(shell.size()) {
  SortedByCell sorted = sorted_by_cell(cells_, shell.size(),
                                       [&](std::size_t i) { return Vec3(shell.x()[i], shell.y()[i], shell.z()[i]); });
  start_ = std::move(sorted.start);
  shell_index_ = std::move(sorted.order);
  keeps_order_ = std::is_sorted(shell_index_.begin(), shell_index_.end());
  for (std::size_t place = 0; place < shell.size(); ++place) {
    const std::uint32_t i = shell_index_[place];
    x_[place] = shell.x()[i];
    y_[place] = shell.y()[i];
    z_[place] = shell.z()[i];
  }
  shell_index_.resize(shell.padded_size());
}

std::vector<std::uint32_t> grid_order(const std::vector<SurfacePoint>& points, double cell_size) {
  const GridCells cells(bounds_of(points), points.size(), cell_size);
  return sorted_by_cell(cells, points.size(), [&](std::size_t i) { return points[i].position; }).order;
}

std::vector<SurfacePoint> in_grid_order(const std::vector<SurfacePoint>& points, double cell_size) {
  std::vector<SurfacePoint> ordered;
  ordered.reserve(points.size());
  for (const std::uint32_t i : grid_order(points, cell_size)) ordered.push_back(points[i]);
  return ordered;
}

}  // namespace hapbench
