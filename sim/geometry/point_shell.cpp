#include "sim/geometry/point_shell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace hapbench {
namespace {

ShellColumns columns_of(const std::vector<SurfacePoint>& points) {
  ShellColumns columns(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) columns.set(i, points[i].position, points[i].normal);
  return columns;
}

}  // namespace

Box bounds_of(const std::vector<SurfacePoint>& points) {
  if (points.empty()) return {};
  Box box{points[0].position, points[0].position};
  for (const SurfacePoint& point : points) box.add(point.position);
  return box;
}

ShellColumns::ShellColumns(std::size_t points) {
  for (UnsetDoubles* column : {&x, &y, &z, &nx, &ny, &nz}) column->resize(simd::padded(points));
}

PointShell::PointShell(ShellColumns columns, std::size_t size, const Box& bounds, double cell_size)
    : size_(size), cell_size_(cell_size), bounds_(bounds), columns_(std::move(columns)) {
  auto& [x, y, z, nx, ny, nz] = columns_;
  for (UnsetDoubles* column : {&x, &y, &z})
    std::fill(column->begin() + static_cast<std::ptrdiff_t>(size), column->end(), kFarAway);
  for (UnsetDoubles* column : {&nx, &ny, &nz})
    std::fill(column->begin() + static_cast<std::ptrdiff_t>(size), column->end(), 0.0);
}

PointShell::PointShell(const std::vector<SurfacePoint>& points, double cell_size, std::vector<std::uint32_t> cells)
    : PointShell(columns_of(points), points.size(), bounds_of(points), cell_size) {
  cells_ = std::move(cells);
}

std::vector<SurfacePoint> PointShell::points() const {
  std::vector<SurfacePoint> all;
  all.reserve(size_);
  for (std::size_t i = 0; i < size_; ++i) all.push_back(point(i));
  return all;
}

std::vector<std::uint32_t> PointShell::cell_of_points() const {
  if (!cells_.empty()) return cells_;
  std::map<std::array<double, 3>, std::uint32_t> cells;
  std::vector<std::uint32_t> cell(size_);
  const auto along = [this](double a) { return std::floor(a / cell_size_ + 0.5); };
  for (std::size_t i = 0; i < size_; ++i) {
    const std::array<double, 3> key{along(x()[i]), along(y()[i]), along(z()[i])};
    cell[i] = cells.try_emplace(key, static_cast<std::uint32_t>(cells.size())).first->second;
  }
  return cell;
}

}  // namespace hapbench
