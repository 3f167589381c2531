#include "sim/geometry/point_shell.hpp"

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "sim/core/simd.hpp"

namespace hapbench {

Box bounds_of(const std::vector<SurfacePoint>& points) {
  if (points.empty()) return {};
  Box box{points[0].position, points[0].position};
  for (const SurfacePoint& point : points) {
    box.min = box.min.cwiseMin(point.position);
    box.max = box.max.cwiseMax(point.position);
  }
  return box;
}

PointShell::PointShell(const std::vector<SurfacePoint>& points, double cell_size, std::vector<std::uint32_t> cells)
    : size_(points.size()), cell_size_(cell_size), bounds_(bounds_of(points)), cells_(std::move(cells)) {
  const std::size_t padded = simd::padded(points.size());
  for (AlignedDoubles* column : {&x_, &y_, &z_}) column->assign(padded, kFarAway);
  for (AlignedDoubles* column : {&nx_, &ny_, &nz_}) column->assign(padded, 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    x_[i] = points[i].position.x();
    y_[i] = points[i].position.y();
    z_[i] = points[i].position.z();
    nx_[i] = points[i].normal.x();
    ny_[i] = points[i].normal.y();
    nz_[i] = points[i].normal.z();
  }
}

SurfacePoint PointShell::point(std::size_t i) const {
  return {{x_[i], y_[i], z_[i]}, {nx_[i], ny_[i], nz_[i]}};
}

std::vector<std::uint32_t> PointShell::cell_of_points() const {
  if (!cells_.empty()) return cells_;
  std::map<std::array<double, 3>, std::uint32_t> cells;
  std::vector<std::uint32_t> cell(size_);
  const auto along = [this](double a) { return std::floor(a / cell_size_ + 0.5); };
  for (std::size_t i = 0; i < size_; ++i) {
    const std::array<double, 3> key{along(x_[i]), along(y_[i]), along(z_[i])};
    cell[i] = cells.try_emplace(key, static_cast<std::uint32_t>(cells.size())).first->second;
  }
  return cell;
}

}  // namespace hapbench
