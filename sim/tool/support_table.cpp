#include "sim/tool/support_table.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hapbench {
namespace {

constexpr std::size_t kEdge = 16;  ///< cells along an edge of the cube
constexpr std::size_t kCells = 6 * kEdge * kEdge;
/// Relative to the size of the body: what is rounding.
constexpr double kTie = 1e-9;

std::size_t cell_along(double coordinate) {
  return std::min(kEdge - 1, static_cast<std::size_t>(0.5 * (coordinate + 1.0) * static_cast<double>(kEdge)));
}

/// The cell of a direction; some cell for one that is zero or not finite.
std::size_t cell_of(const Vec3& u) {
  Eigen::Index axis = 0;
  const double largest = u.cwiseAbs().maxCoeff(&axis);
  if (!(largest > 0.0 && largest < std::numeric_limits<double>::infinity())) return 0;
  const std::size_t side = 2 * static_cast<std::size_t>(axis) + (u[axis] < 0.0 ? 1 : 0);
  return (side * kEdge + cell_along(u[(axis + 1) % 3] / largest)) * kEdge + cell_along(u[(axis + 2) % 3] / largest);
}

/// The unit direction at (a, b) of the cell, 0 to 1 across it.
Vec3 direction_in(std::size_t cell, double a, double b) {
  const auto along = [](std::size_t i, double t) {
    return 2.0 * (static_cast<double>(i) + t) / static_cast<double>(kEdge) - 1.0;
  };
  const std::size_t side = cell / (kEdge * kEdge);
  const auto axis = static_cast<Eigen::Index>(side / 2);
  Vec3 u;
  u[axis] = side % 2 == 0 ? 1.0 : -1.0;
  u[(axis + 1) % 3] = along(cell / kEdge % kEdge, a);
  u[(axis + 2) % 3] = along(cell % kEdge, b);
  return u.normalized();
}

std::vector<std::uint32_t> foremost_in_cell(const std::vector<Vec3>& points, std::size_t cell, double tie) {
  const Vec3 middle = direction_in(cell, 0.5, 0.5);
  // A cell is bounded by great circles, so that its corners are furthest from its middle.
  double radius = 0.0;
  for (const double a : {0.0, 1.0}) {
    for (const double b : {0.0, 1.0}) radius = std::max(radius, (direction_in(cell, a, b) - middle).norm());
  }
  const auto behind = [&](const Vec3& a, const Vec3& b) { return a.dot(middle) < b.dot(middle); };
  const Vec3& first = *std::max_element(points.begin(), points.end(), behind);
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (middle.dot(first - points[i]) <= radius * (points[i] - first).norm() + tie)
      found.push_back(static_cast<std::uint32_t>(i));
  }
  return found;
}

}  // namespace

SupportTable::SupportTable(std::vector<Vec3> points) : points_(std::move(points)), starts_{0} {
  Vec3 low = points_.front(), high = low;
  for (const Vec3& p : points_) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  tie_ = kTie * (high - low).norm();
  std::vector<std::vector<std::uint32_t>> cells(kCells);
  tbb::parallel_for(std::size_t{0}, kCells,
                    [&](std::size_t i) { cells[i] = foremost_in_cell(points_, i, 2.0 * tie_); });
  for (const auto& cell : cells) {
    listed_.insert(listed_.end(), cell.begin(), cell.end());
    starts_.push_back(static_cast<std::uint32_t>(listed_.size()));
  }
}

std::span<const std::uint32_t> SupportTable::candidates(const Vec3& direction) const noexcept {
  const std::size_t cell = cell_of(direction);
  return {listed_.data() + starts_[cell], listed_.data() + starts_[cell + 1]};
}

double SupportTable::support(const Vec3& direction) const noexcept {
  double most = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : candidates(direction)) most = std::max(most, direction.dot(points_[i]));
  return most;
}

Vec3 SupportTable::foremost(const Vec3& direction, const Vec3& abreast) const noexcept {
  const double least = support(direction) - tie_;
  const Vec3* nearest = nullptr;
  double distance2 = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : candidates(direction)) {
    if (direction.dot(points_[i]) < least) continue;
    const double d2 = (points_[i] - abreast).squaredNorm();
    if (nearest == nullptr || d2 < distance2) {
      nearest = &points_[i];
      distance2 = d2;
    }
  }
  if (nearest == nullptr) return points_.front();  // a direction that is not finite
  // Towards the other points as long as that comes nearer; twice, for faces. Any mean of foremost places is one.
  Vec3 place = *nearest;
  for (int pass = 0; pass < 2; ++pass) {
    for (const std::uint32_t i : candidates(direction)) {
      if (direction.dot(points_[i]) < least) continue;
      const Vec3 way = points_[i] - place;
      const double length2 = way.squaredNorm();
      if (length2 > 0.0) place += std::clamp((abreast - place).dot(way) / length2, 0.0, 1.0) * way;
    }
  }
  return place;
}

}  // namespace hapbench
