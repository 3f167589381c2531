#include "sim/geometry/point_shell.hpp"

#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "sim/geometry/grid_index.hpp"

namespace hapbench {

Box bounds_of(const std::vector<SurfacePoint>& points) {
  if (points.empty()) return {};
  Box box{points.front().position, points.front().position};
  for (const SurfacePoint& point : points) box.add(point.position);
  return box;
}

struct PointShell::SearchData {
  std::mutex mutex;
  std::unique_ptr<const GridIndex> grid;
  std::map<double, std::size_t> max_points_in_ball;  ///< by the radius [m]
};

PointShell::PointShell(const std::vector<SurfacePoint>& points, double cell_size, std::vector<std::uint32_t> cells)
    : size_(points.size()),
      cell_size_(cell_size),
      bounds_(bounds_of(points)),
      columns_(points.size()),
      cells_(std::move(cells)),
      search_data_(std::make_shared<SearchData>()) {
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

const GridIndex& PointShell::grid() const {
  const std::lock_guard lock(search_data_->mutex);
  if (!search_data_->grid) search_data_->grid = std::make_unique<const GridIndex>(*this);
  return *search_data_->grid;
}

std::size_t PointShell::max_points_in_ball(double radius) const {
  const std::lock_guard lock(search_data_->mutex);
  std::map<double, std::size_t>& known = search_data_->max_points_in_ball;
  if (const auto found = known.find(radius); found != known.end()) return found->second;
  return known.emplace(radius, max_points_in_cube(*this, radius)).first->second;
}

}  // namespace hapbench
