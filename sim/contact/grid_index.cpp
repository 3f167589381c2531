#include "sim/contact/grid_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>


namespace hapbench {
namespace {

/// Edge of a cell in distances of neighbouring points.
constexpr double kSpacingsPerCell = 2.5;
/// Cells per point at most; shells are surfaces, so most cells of their box are empty anyway.
constexpr double kCellsPerPoint = 8.0;
constexpr double kFewestCells = 4096.0;

/// Distance of neighbours if the points were spread evenly over the faces of their box.
double even_spacing(const Vec3& extent, double points) {
  const double area = 2.0 * (extent.x() * extent.y() + extent.y() * extent.z() + extent.z() * extent.x());
  return area > 0.0 ? std::sqrt(area / points) : extent.maxCoeff() / points;
}

}  // namespace

GridIndex::GridIndex(const PointShell& shell)
    : x_(shell.padded_size(), PointShell::kFarAway),
      y_(shell.padded_size(), PointShell::kFarAway),
      z_(shell.padded_size(), PointShell::kFarAway),
      shell_index_(shell.padded_size()),
      shell_size_(shell.size()) {
  choose_cells(shell);
  start_.assign(count_[0] * count_[1] * count_[2] + 1, 0);
  std::vector<std::uint32_t> cell(shell.size());
  for (std::size_t i = 0; i < shell.size(); ++i) {
    cell[i] = cell_of({shell.x()[i], shell.y()[i], shell.z()[i]});
    ++start_[cell[i] + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  // Counting sort: each point goes to the next place of its cell, so those of a cell keep their order.
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < shell.size(); ++i) {
    const std::uint32_t sorted = next[cell[i]]++;
    keeps_order_ = keeps_order_ && sorted == i;
    shell_index_[sorted] = static_cast<std::uint32_t>(i);
    x_[sorted] = shell.x()[i];
    y_[sorted] = shell.y()[i];
    z_[sorted] = shell.z()[i];
  }
}

void GridIndex::choose_cells(const PointShell& shell) {
  bounds_ = shell.bounds();
  const Vec3 extent = bounds_.max - bounds_.min;
  const double points = std::max(1.0, static_cast<double>(shell.size()));
  const double spacing = shell.cell_size() > 0.0 ? shell.cell_size() : even_spacing(extent, points);
  cell_ = spacing > 0.0 ? kSpacingsPerCell * spacing : 1.0;
  origin_ = bounds_.min;
  const auto cells = [&](int axis) { return std::floor(extent[axis] / cell_) + 1.0; };
  while (cells(0) * cells(1) * cells(2) > std::max(kFewestCells, kCellsPerPoint * points)) cell_ *= 1.25;
  for (int axis = 0; axis < 3; ++axis) count_[axis] = static_cast<std::size_t>(cells(axis));
}

std::uint32_t GridIndex::cell_of(const Vec3& point) const {
  std::size_t index = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = std::floor((point[axis] - origin_[axis]) / cell_);
    const auto last = static_cast<double>(count_[axis] - 1);
    index = index * count_[axis] + static_cast<std::size_t>(std::clamp(along, 0.0, last));
  }
  return static_cast<std::uint32_t>(index);
}

std::vector<std::uint32_t> grid_order(const std::vector<SurfacePoint>& points, double cell_size) {
  const GridIndex grid(PointShell(points, cell_size));
  return {grid.shell_indices(), grid.shell_indices() + points.size()};
}

std::vector<SurfacePoint> in_grid_order(const std::vector<SurfacePoint>& points, double cell_size) {
  std::vector<SurfacePoint> ordered;
  ordered.reserve(points.size());
  for (const std::uint32_t i : grid_order(points, cell_size)) ordered.push_back(points[i]);
  return ordered;
}

GridIndex::Range GridIndex::range(double low, double high, int axis) const {
  // The same expression as cell_of, which is monotone in the coordinate: no point in the box can be in a cell outside.
  const double first = std::floor((low - origin_[axis]) / cell_), last = std::floor((high - origin_[axis]) / cell_);
  const auto end = static_cast<double>(count_[axis] - 1);
  if (!(last >= 0.0 && first <= end)) return {};
  return {static_cast<std::size_t>(std::max(first, 0.0)), static_cast<std::size_t>(std::min(last, end))};
}

}  // namespace hapbench
