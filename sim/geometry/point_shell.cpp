#include "sim/geometry/point_shell.hpp"

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
  Box box{points.front().position, points.front().position};
  for (const SurfacePoint& point : points) box.add(point.position);
  return box;
}

ShellColumns::ShellColumns(std::size_t points) {
  for (UnsetDoubles* column : {&x, &y, &z, &nx, &ny, &nz}) column->resize(simd::padded(points));
}

PointShell::PointShell(ShellColumns columns, std::size_t size, const Box& bounds, double cell_size)
    : size_(size), cell_size_(cell_size), bounds_(bounds), columns_(std::move(columns)) {
  for (std::size_t i = size; i < padded_size(); ++i) columns_.set(i, Vec3::Constant(kFarAway), Vec3::Zero());
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
