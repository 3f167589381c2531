#include "sim/contact/inside.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hapbench {
namespace {

constexpr std::size_t kAtOnce = 4;  ///< cells halved at once, whose eight halves the tool is asked about in one call
/// A cell is halved some 60 times at most before it is smaller than the tolerance, and every time adds four to the
/// stack.
constexpr std::size_t kMostCells = 1024;
constexpr std::size_t kMostLooks = 20000;
/// Relative to the half width: a point this little outside the tool counts as in it; the step of differences of phi;
/// cells this small are not searched beyond the border.
constexpr double kOnTool = 1e-9, kDifference = 1e-3, kCoarse = 0.25;

}  // namespace

InsideSearch::InsideSearch(const ToolShape& tool, const Solid& solid)
    : tool_(tool),
      solid_(solid),
      error_(solid.error() + tool.surface_error()),
      points_(2 * kAtOnce),
      one_(1),
      x_(2 * simd::lanes),
      y_(x_),
      z_(x_) {
  cells_.reserve(kMostCells);
}

std::optional<double> InsideSearch::depth(const ToolPose& pose, double known, double tolerance) noexcept {
  best_ = known;
  looks_ += 8;  // of the tip and where it leads
  tolerance_ = tolerance;
  const SurfaceDistance tip = solid_.at(pose.position);
  const LookedUp looked{pose.position, tip.value};
  beyond_border_ = !tip.known;
  cells_.clear();
  improve(pose, pose.position);  // finds what is less deep than the tolerance, too
  const Box box = tool_.box_near(pose, 0.0, solid_.region());
  const Vec3 low = box.min.cwiseMax(solid_.region().min), high = box.max.cwiseMin(solid_.region().max);
  if ((low.array() <= high.array()).all()) {
    const Vec3 half = 0.5 * (high - low);
    // Halved once at first, so that the whole box need not be looked at.
    cells_.push_back({0.5 * (low + high), half, std::abs(tip.value) + 2.0 * tool_.reach(), looked});
  }
  for (std::size_t looks = 0; !cells_.empty() && looks < kMostLooks; looks += 2 * kAtOnce) {
    std::array<Cell, kAtOnce> parents;
    std::size_t count = 0;
    while (count < kAtOnce && !cells_.empty()) {
      if (may_be_deepest(cells_.back().bound)) parents[count++] = cells_.back();
      cells_.pop_back();
    }
    look(pose, parents.data(), count);
  }
  return best_ == 0.0 && beyond_border_ ? std::nullopt : std::optional(best_);
}

/// Halves the cells across their longest edges and keeps the halves that may hold a deeper point.
void InsideSearch::look(const ToolPose& pose, const Cell* parents, std::size_t count) noexcept {
  std::array<Cell, 2 * kAtOnce> halves;
  points_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Index axis = 0;
    parents[i].half.maxCoeff(&axis);
    for (const double side : {-0.5, 0.5}) {
      Cell& half = halves[points_.size()] = parents[i];
      half.centre[axis] += side * half.half[axis];
      half.half[axis] *= 0.5;
      half.bound = solid_.deepest_in({half.centre - half.half, half.centre + half.half});
      points_.push(0, half.centre, Vec3::UnitZ());
    }
  }
  if (points_.empty()) return;
  tool_.surface_constraints(pose, Vec3::Zero(), 0.0, points_);
  const std::size_t first = cells_.size();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Cell cell = halves[i];
    double radius = cell.half.norm();
    const double outside = -points_.depth[i];  // of the tool
    if (!(outside <= radius)) continue;
    // Projecting on a convex body brings no two points further apart.
    Vec3 place = cell.centre;
    const Vec3 gradient = points_.gradient(i);
    if (outside > 0.0) {
      place -= outside * gradient;
      if (!tool_.convex()) radius += outside;
    }
    // Nothing is deeper than the way to the surface that is known.
    const double way = (place - cell.looked.place).norm();
    if (!may_be_deepest(radius + way - cell.looked.value)) continue;
    ++looks_;
    const SurfaceDistance phi = solid_.at(place, &cell.looked);
    if (phi.value >= radius) continue;
    cell.looked = {place, phi.value};
    cell.bound = std::min(cell.bound, radius - phi.value);
    if (!may_be_deepest(cell.bound)) continue;
    if (phi.known) {
      if (-phi.value > best_ && (outside <= 0.0 || into_tool(pose, place))) improve(pose, place);
    } else if (radius < kCoarse * tool_.half_width()) {
      beyond_border_ = beyond_border_ || phi.value < -best_;
      continue;
    }
    if (cells_.size() < kMostCells) cells_.push_back(cell);
  }
  std::sort(cells_.begin() + static_cast<std::ptrdiff_t>(first), cells_.end(),
            [](const Cell& a, const Cell& b) { return a.bound < b.bound; });
}

/// Moves a point near the tool into it, unless it is there. The distances of a mesh are approximate.
bool InsideSearch::into_tool(const ToolPose& pose, Vec3& point) noexcept {
  for (int round = 0; round < 3; ++round) {
    one_.clear();
    one_.push(0, point, Vec3::UnitZ());
    tool_.surface_constraints(pose, Vec3::Zero(), 0.0, one_);
    if (-one_.depth[0] <= kOnTool * tool_.half_width()) return true;
    point += one_.depth[0] * one_.gradient(0);
  }
  return false;
}

/// Follows the depth from a place of the tool to deeper ones.
void InsideSearch::improve(const ToolPose& pose, Vec3 place) noexcept {
  constexpr int kMoves = 8, kHalvings = 6;
  const PlaceArrays answer{x_.data(), y_.data(), z_.data()};
  LookedUp last{place, solid_.at(place).value};
  const auto try_place = [&](Vec3 q) {
    if (!into_tool(pose, q)) return false;
    const SurfaceDistance phi = solid_.at(q, &last);
    last = {q, phi.value};
    if (!phi.known || !(-phi.value > best_)) return false;
    best_ = -phi.value;
    place = q;
    return true;
  };
  try_place(Vec3(place));
  for (int move = 0; move < kMoves; ++move) {
    one_.clear();
    one_.push(0, place, solid_.gradient(place, kDifference * tool_.half_width()));
    tool_.foremost_places(pose, one_, answer);
    const Vec3 way = Vec3(x_[0], y_[0], z_[0]) - place;
    bool moved = false;
    double part = 1.0;
    for (int i = 0; i < kHalvings && !moved; ++i, part *= 0.5) moved = try_place(place + part * way);
    if (!moved) return;
  }
}

}  // namespace hapbench
