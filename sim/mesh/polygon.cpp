#include "sim/mesh/polygon.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

namespace hapbench {
namespace {

/// Rounding error of coordinates in single precision, relative to the largest coordinate; with a margin.
constexpr double kSingleRounding = 2.5e-7;
/// Length that counts as zero, relative to the diameter of a polygon. Files often hold coordinates of six or seven
/// digits.
constexpr double kSmallLength = 1e-6;
/// If the area vector of a polygon is not longer than this number times the square of the diameter, the polygon's plane
/// cannot be determined from it.
constexpr double kSmallArea = 1e-9;
/// The corners of a triangle count as collinear up to this doubled area, relative to the square of the diameter.
constexpr double kFlat = 1e-12;
/// Ear quality of a spike, a corner whose two neighbours are at the same position. Larger than the quality of every
/// triangle, so that spikes are clipped first: an ear beside a spike may lie outside the polygon.
constexpr double kSpike = 1.0;

std::string percent(double fraction) {
  return std::to_string(static_cast<int>(100.0 * fraction + 0.5)) + " %";
}

}  // namespace

const DividedPolygon& PolygonDivider::divide(std::span<const Vec3> corners) {
  divided_.triangles.clear();
  divided_.unevenness = 0.0;
  divided_.repeated_corners = 0;
  const bool has_plane = project(corners);
  if (has_plane && divided_.unevenness > kMaxUnevenness) {
    throw PolygonError("is not planar: a corner is off its plane by " + percent(divided_.unevenness) +
                       " of its diameter; allowed: " + percent(kMaxUnevenness) + ", or triangles");
  }
  const Fan fan = has_plane ? this->fan() : Fan::good;
  if (fan == Fan::good || (fan == Fan::has_flat_triangles && corners.size() > kMaxPolygonCorners)) {
    for (std::uint32_t k = 2; k < corners.size(); ++k) divided_.triangles.push_back({0, k - 1, k});
    return divided_;
  }
  if (corners.size() > kMaxPolygonCorners) {
    throw PolygonError("has " + std::to_string(corners.size()) + " corners and is not convex; allowed: at most " +
                       std::to_string(kMaxPolygonCorners) + ", or triangles");
  }
  drop_repeated_corners();
  refuse_crossings();
  clip_ears();
  return divided_;
}

bool PolygonDivider::project(std::span<const Vec3> corners) {
  // Compute the diameter of the polygon, defined as the diagonal of its bounding box.
  Box box = Box::nothing();
  double largest = 0.0;
  for (const Vec3& p : corners) {
    box.add(p);
    largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  const double diameter = box.size().norm();
  points_.clear();
  if (diameter == 0.0) return false;
  rounding_ = kSmallLength + kSingleRounding * largest / diameter;
  const auto relative = [&](std::size_t i) { return Vec3((corners[i] - corners[0]) / diameter); };
  // Compute the area vector and the mean of the corners, relative to the first corner and in units of the diameter.
  Vec3 area = Vec3::Zero(), mean = Vec3::Zero();
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (i + 1 < corners.size()) area += relative(i).cross(relative(i + 1));
    mean += relative(i) / static_cast<double>(corners.size());
  }
  const double size = area.norm();
  if (size <= kSmallArea) {
    // Determine whether all corners are on a line, which has no plane. Otherwise parts of the polygon with opposite
    // winding cancel each other.
    Eigen::Index axis = 0;
    box.size().maxCoeff(&axis);
    const auto on_axis = [&](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; };
    const auto ends = std::ranges::minmax_element(corners, on_axis);
    const Vec3 low = *ends.min, direction = (*ends.max - low).normalized();
    const bool is_line = std::ranges::all_of(corners, [&](const Vec3& p) {
      return (p - low).cross(direction).norm() <= std::max(rounding_, 2.0 * kSmallArea) * diameter;
    });
    if (!is_line) throw PolygonError("crosses itself: its parts have opposite winding; allowed: a simple polygon");
    return false;
  }
  // Choose axes in the plane, and compute the coordinates of the corners along these axes.
  const Vec3 normal = area / size;
  const Vec3 x_axis = normal.unitOrthogonal(), y_axis = normal.cross(x_axis);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 p = relative(i);
    points_.push_back({p.dot(x_axis), p.dot(y_axis), static_cast<std::uint32_t>(i)});
    divided_.unevenness = std::max(divided_.unevenness, std::abs((p - mean).dot(normal)));
  }
  return true;
}

/// Tests the fan by the directions from the first corner to the other corners. These directions must turn
/// counter-clockwise only, and by less than a full turn in total.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): the cases of a corner share one walk.
PolygonDivider::Fan PolygonDivider::fan() const {
  const Point &first = points_[0], *start = nullptr, *last = nullptr;
  bool is_past_half = false, has_flat = false;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const Point& p = points_[i];
    if (is_same_position(first, p)) {
      has_flat = true;
      continue;
    }
    if (last != nullptr) {
      const double turn = doubled_area(first, *last, p), from_start = doubled_area(first, *start, p);
      const double dot = (last->x - first.x) * (p.x - first.x) + (last->y - first.y) * (p.y - first.y);
      if (turn < -rounding_ || (turn <= 0.0 && dot < 0.0)) return Fan::invalid;
      if (from_start < -rounding_) is_past_half = true;
      if (is_past_half && from_start > rounding_) return Fan::invalid;
      // A triangle is flat if its height over the longest side is at most rounding_.
      const double longest =
          std::max({squared_distance(first, *last), squared_distance(first, p), squared_distance(*last, p)});
      if (turn <= rounding_ * std::sqrt(longest)) has_flat = true;
    } else {
      start = &p;
    }
    last = &p;
  }
  return has_flat ? Fan::has_flat_triangles : Fan::good;
}

void PolygonDivider::drop_repeated_corners() {
  // Repeat until nothing changes, because a spike may have several corners on each side.
  std::size_t i = 0, unchanged = 0;
  while (unchanged < points_.size() && points_.size() > 3) {
    const Point &previous = points_[before(i)], &next = points_[after(i)];
    if (is_same_position(points_[i], next) || is_same_position(previous, next)) {
      points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(i));
      ++divided_.repeated_corners;
      unchanged = 0;
      i = i == 0 ? points_.size() - 1 : i - 1;
    } else {
      ++unchanged;
      i = after(i);
    }
  }
}

/// Throws PolygonError if two edges cross, or if the direction along the boundary does not make exactly one full turn
/// (turns_once()). Edges may touch and overlap.
void PolygonDivider::refuse_crossings() const {
  // Sort the edges by their smallest x, so that only edges with overlapping x are compared.
  struct Edge {
    const Point *from, *to;
    double min_x, max_x, length;
  };
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point &a = points_[i], &b = points_[after(i)];
    edges.push_back({&a, &b, std::min(a.x, b.x), std::max(a.x, b.x), std::sqrt(squared_distance(a, b))});
  }
  std::ranges::stable_sort(edges, {}, &Edge::min_x);
  // Returns true if the ends of `other` are clearly on different sides of `edge`.
  const auto separates = [this](const Edge& edge, const Edge& other) {
    const double one = doubled_area(*edge.from, *edge.to, *other.from);
    const double two = doubled_area(*edge.from, *edge.to, *other.to);
    return (one < 0.0) != (two < 0.0) && std::min(std::abs(one), std::abs(two)) > rounding_ * edge.length;
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size() && edges[j].min_x <= edges[i].max_x; ++j) {
      if (!separates(edges[i], edges[j]) || !separates(edges[j], edges[i])) continue;
      const auto name = [](const Edge& edge) {
        return std::to_string(edge.from->corner + 1) + " and " + std::to_string(edge.to->corner + 1);
      };
      throw PolygonError("crosses itself: the edge between its corners " + name(edges[i]) +
                         " crosses the edge between its corners " + name(edges[j]) + "; allowed: a simple polygon");
    }
  }
  if (!turns_once())
    throw PolygonError("crosses itself: its boundary winds around several times; allowed: a simple polygon");
}

/// Returns true if the direction along the boundary makes one full turn in total. Also returns true if rounding would
/// decide the result.
bool PolygonDivider::turns_once() const {
  int turns = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point &a = points_[before(i)], &b = points_[i], &c = points_[after(i)];
    const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - b.x, vy = c.y - b.y;
    const double cross = ux * vy - uy * vx, dot = ux * vx + uy * vy;
    const double length = std::sqrt(ux * ux + uy * uy);
    if (length < rounding_ || (dot < 0.0 && std::abs(cross) <= rounding_ * length)) return true;
    // Count the turns: +1 if the direction crosses +x counter-clockwise, -1 if it crosses +x clockwise.
    if (uy < 0.0 && vy >= 0.0 && cross > 0.0) ++turns;
    if (uy >= 0.0 && vy < 0.0 && cross < 0.0) --turns;
  }
  return turns == 1;
}

double PolygonDivider::ear_quality(std::size_t i) const {
  const Point &a = points_[before(i)], &b = points_[i], &c = points_[after(i)];
  if (is_same_position(a, c)) return kSpike;
  const double area = doubled_area(a, b, c);
  if (area <= kFlat) return 0.0;
  for (std::size_t j = 0; j < points_.size(); ++j)
    if (blocks(j, a, b, c)) return 0.0;
  return area / (squared_distance(a, b) + squared_distance(b, c) + squared_distance(c, a));
}

bool PolygonDivider::blocks(std::size_t j, const Point& a, const Point& b, const Point& c) const {
  const Point& p = points_[j];
  if (doubled_area(a, b, p) < 0.0 || doubled_area(b, c, p) < 0.0) return false;
  const double inside = doubled_area(c, a, p);
  if (inside >= 0.0) {
    // A corner in the ear blocks the ear only if the corner is reflex or collinear with its neighbours.
    if (is_same_position(p, a) || is_same_position(p, b) || is_same_position(p, c)) return false;
    return doubled_area_at(j) <= kFlat;
  }
  // A corner that lies on the new edge up to rounding would later form a flat triangle with this edge.
  const double length2 = squared_distance(c, a), along = (p.x - c.x) * (a.x - c.x) + (p.y - c.y) * (a.y - c.y);
  return -inside <= rounding_ * std::sqrt(length2) && along > 0.0 && along < length2;
}

std::size_t PolygonDivider::flattest_corner() const {
  std::size_t flattest = points_.size(), largest = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double area = doubled_area_at(i);
    if (std::abs(area) <= rounding_ &&
        (flattest == points_.size() || std::abs(area) < std::abs(doubled_area_at(flattest))))
      flattest = i;
    if (area > doubled_area_at(largest)) largest = i;
  }
  if (flattest < points_.size()) return flattest;
  if (doubled_area_at(largest) > 0.0) return largest;
  throw PolygonError("crosses itself; allowed: a simple polygon");
}

void PolygonDivider::clip(std::size_t i) {
  // The two edges of a spike cover each other and need no triangle.
  const Point &a = points_[before(i)], &b = points_[i], &c = points_[after(i)];
  if (!is_same_position(a, c)) divided_.triangles.push_back({a.corner, b.corner, c.corner});
  points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(i));
  qualities_.erase(qualities_.begin() + static_cast<std::ptrdiff_t>(i));
  const std::size_t next = i == points_.size() ? 0 : i;
  for (const std::size_t k : {before(next), next}) qualities_[k] = ear_quality(k);
}

void PolygonDivider::clip_ears() {
  qualities_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) qualities_[i] = ear_quality(i);
  while (points_.size() > 3) {
    auto best = std::ranges::max_element(qualities_);
    // If no ear is known, compute the qualities again until an ear is found: a clipped corner no longer blocks ears.
    for (std::size_t i = 0; i < points_.size() && *best == 0.0; ++i) {
      qualities_[i] = ear_quality(i);
      best = qualities_.begin() + static_cast<std::ptrdiff_t>(i);
    }
    clip(*best > 0.0 ? static_cast<std::size_t>(best - qualities_.begin()) : flattest_corner());
  }
  // Three corners are left. If their triangle is not reversed either, the triangles cover the polygon exactly once,
  // provided that the polygon does not cross itself.
  if (doubled_area_at(1) < -rounding_) throw PolygonError("crosses itself; allowed: a simple polygon");
  clip(1);
}

}  // namespace hapbench
