#include "device_model/hands/drag_hand.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hapbench {

constexpr int kPasses = 3;
/// Sine of the angle between direction and normal below which a path ends. Its square is the share of a step by which a
/// path must advance along the direction; beyond the edge of a surface the nearest place is that edge.
constexpr double kLeastProgress = 0.1;

/// Calls visit(i) for the sorted points in the cells of the grid that the cube around the centre meets.
template <class Visit>
static void for_each_near(const GridIndex& grid, const Vec3& centre, double half, const Visit& visit) {
  const Box cube{centre - Vec3::Constant(half), centre + Vec3::Constant(half)};
  grid.for_each_run(cube, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) visit(i);
  });
}

std::size_t SmoothedSurface::nearest_point(const Vec3& at) const {
  std::size_t nearest = 0;
  double least2 = std::numeric_limits<double>::infinity();
  // Ends when the box contains the whole ball around `at` that has the nearest point found on its surface.
  for (double half = distance_to(shell_.bounds(), at) + grid_.cell_size(); least2 > half * half; half *= 2.0) {
    for_each_near(grid_, at, half, [&](std::size_t i) {
      const double distance2 = (Vec3(grid_.x()[i], grid_.y()[i], grid_.z()[i]) - at).squaredNorm();
      if (distance2 >= least2) return;
      least2 = distance2;
      nearest = grid_.shell_indices()[i];
    });
  }
  return nearest;
}

SurfacePoint SmoothedSurface::nearest(const Vec3& at) const {
  const SurfacePoint start = shell_.point(nearest_point(at));
  SurfacePoint before = start, place = start;
  for (int pass = 0; pass < kPasses; ++pass) {
    double weights = 0.0;
    Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
    for_each_near(grid_, place.position, radius_, [&](std::size_t i) {
      const SurfacePoint point = shell_.point(grid_.shell_indices()[i]);
      const double nearness = 1.0 - (point.position - place.position).squaredNorm() / (radius_ * radius_);
      if (nearness <= 0.0 || point.normal.dot(start.normal) <= 0.0) return;
      const double weight = nearness * nearness;
      weights += weight;
      centre += weight * point.position;
      normal += weight * point.normal;
    });
    if (!(weights > 0.0)) return before;
    normal.normalize();
    centre /= weights;
    before = place;
    place = {at - normal.dot(at - centre) * normal, normal};
  }
  return place;
}

/// Interpolates between unit vectors.
static Vec3 between(const Vec3& a, const Vec3& b, double fraction) {
  return unit_or(a + fraction * (b - a), a);
}

static SurfacePoint between(const SurfacePoint& a, const SurfacePoint& b, double fraction) {
  return {a.position + fraction * (b.position - a.position), between(a.normal, b.normal, fraction)};
}

SurfacePath::SurfacePath(const SmoothedSurface& surface, std::span<const SurfacePoint> places)
    : radius_(surface.radius()), spacing_(spacing(radius_)), entries_{places.front()} {
  double total = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) total += (places[i].position - places[i - 1].position).norm();
  const auto pieces = static_cast<std::size_t>(std::ceil(total / spacing_));
  if (pieces > 0) spacing_ = total / static_cast<double>(pieces);
  double left = spacing_;  // distance to the next entry
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double leg = (places[i].position - places[i - 1].position).norm();
    double done = 0.0;
    for (; leg - done >= left && entries_.size() < pieces; left = spacing_) {
      done += left;
      entries_.push_back(between(places[i - 1], places[i], done / leg));
    }
    left -= leg - done;
  }
  entries_.resize(pieces + 1, places.back());
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const auto& [place, normal] = entries_[i];
    const Vec3 leftwards = normal.cross(direction(static_cast<double>(i) * spacing_));
    Normals& row = normals_.emplace_back();
    for (std::size_t k = 0; k < row.size(); ++k) {
      const double aside = (static_cast<double>(k) - static_cast<double>(kSide)) * radius_;
      row[k] = k == kSide ? normal : surface.nearest(place + aside * leftwards).normal;
    }
  }
}

SurfacePath SurfacePath::over(const SmoothedSurface& surface, std::span<const Vec3> points) {
  const double step = spacing(surface.radius());
  std::vector<SurfacePoint> places = {surface.nearest(points.front())};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 leg = points[i] - points[i - 1];
    const double pieces = std::max(1.0, std::ceil(leg.norm() / step));
    for (double k = 1.0; k <= pieces; ++k) places.push_back(surface.nearest(points[i - 1] + (k / pieces) * leg));
  }
  return {surface, places};
}

/// Places on the surface from `first` along the unit vector `forward`, `step` apart.
static std::vector<SurfacePoint> walk(const SmoothedSurface& surface, const SurfacePoint& first, const Vec3& forward,
                                      double length, double step) {
  std::vector<SurfacePoint> places = {first};
  for (double done = 0.0; done < length; done += step) {
    const SurfacePoint& here = places.back();
    const Vec3 within = forward - here.normal.dot(forward) * here.normal;
    if (within.norm() < kLeastProgress) break;
    const SurfacePoint next = surface.nearest(here.position + step * within.normalized());
    if (forward.dot(next.position - here.position) < kLeastProgress * kLeastProgress * step) break;
    places.push_back(next);
  }
  return places;
}

SurfacePath SurfacePath::along(const SmoothedSurface& surface, const Vec3& start, const Vec3& direction,
                               double length) {
  const Vec3 forward = direction.normalized();
  const double step = spacing(surface.radius());
  const SurfacePoint first = surface.nearest(start);
  std::vector<SurfacePoint> places = walk(surface, first, forward, length, step);
  // If it was found from far above a rough surface, the first place may lie off it, and the first step leads back.
  if (places.size() == 1) places = walk(surface, surface.nearest(first.position), forward, length, step);
  return {surface, places};
}

SurfacePath::Position SurfacePath::position(double s) const noexcept {
  const double entry = std::clamp(s, 0.0, length()) / spacing_;
  const auto before = std::min(static_cast<std::size_t>(entry), entries_.size() - 1);
  return {before, std::min(before + 1, entries_.size() - 1), entry - static_cast<double>(before)};
}

SurfacePoint SurfacePath::at(double s) const noexcept {
  const auto [before, after, fraction] = position(s);
  return between(entries_[before], entries_[after], fraction);
}

Vec3 SurfacePath::normal_near(const Vec3& x, double s) const noexcept {
  const auto [before, after, fraction] = position(s);
  const auto& [place, normal] = between(entries_[before], entries_[after], fraction);
  const double aside = normal.cross(direction(s)).dot(x - place) / radius_;
  const double column = std::clamp(aside + static_cast<double>(kSide), 0.0, 2.0 * static_cast<double>(kSide));
  const auto right = std::min(static_cast<std::size_t>(column), 2 * kSide - 1);
  const auto across = [&](const Normals& row) {
    return between(row[right], row[right + 1], column - static_cast<double>(right));
  };
  return between(across(normals_[before]), across(normals_[after]), fraction);
}

Vec3 SurfacePath::direction(double s) const noexcept {
  const double here = std::clamp(s, 0.0, length());
  const Vec3 normal = at(here).normal;
  const Vec3 way = at(here + radius_).position - at(here - radius_).position;
  const Vec3 within = way - normal.dot(way) * normal;
  const double norm = within.norm();
  return norm > 0.0 ? Vec3(within / norm) : normal.unitOrthogonal();
}

Vec3 DragHand::force(double t, const HandView& view) noexcept {
  const auto& [x, v] = view.handle;
  // Moves half of the way to the foot of the perpendicular on the path. It arrives in a few steps and stays there on
  // bent paths, on which the whole way would overshoot.
  nearest_ += 0.5 * path_->direction(nearest_).dot(x - path_->at(nearest_).position);
  nearest_ = std::clamp(nearest_, 0.0, path_->length());
  const Vec3 n = path_->normal_near(x, nearest_);

  const double s = drag_.speed * t;
  Vec3 pull = drag_.stiffness * (path_->at(s).position - x) - drag_.damping * v;
  if (s < path_->length()) pull += drag_.damping * drag_.speed * path_->direction(s);
  return pull - n.dot(pull) * n - (drag_.force(t) + drag_.normal_damping * n.dot(v)) * n;
}

}  // namespace hapbench
