#include "sim/geometry/point_shell.hpp"

#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace hapbench {

Box bounds_of(const std::vector<SurfacePoint>& points) {
  if (points.empty()) return {};
  Box box{points.front().position, points.front().position};
  for (const SurfacePoint& point : points) box.add(point.position);
  return box;
}

PointShell::PointShell(const std::vector<SurfacePoint>& points, double cell_size, std::vector<std::uint32_t> cells)
    : size_(points.size()),
      cell_size_(cell_size),
      bounds_(bounds_of(points)),
      columns_(points.size()),
      cells_(std::move(cells)) {
  for (std::size_t i = 0; i < size_; ++i) columns_.set(i, points[i].position, points[i].normal);
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
