#include "device_model/hands/drag_hand.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/geometry/grid_index.hpp"

namespace hapbench {

/// Number of projections of a position onto the local plane in SmoothedSurface::nearest.
constexpr int kProjections = 3;
/// A path ends where the sine of the angle between its direction and the surface's normal falls below kMinProgress. The
/// path also ends if a step of length h advances along its direction by less than kMinProgress^2 h. Such a step occurs
/// at the border of the surface, because all positions beyond the border are projected onto the border.
constexpr double kMinProgress = 0.1;

/// Calls visit(i) for all points i in the grid cells that intersect the cube with this centre and half width [m]. Some
/// of these points may lie outside the cube.
template <class Visit>
static void for_each_near(const GridIndex& grid, const Vec3& centre, double half, const Visit& visit) {
  const Box cube{centre - Vec3::Constant(half), centre + Vec3::Constant(half)};
  grid.for_each_run(cube, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) visit(i);
  });
}

std::size_t SmoothedSurface::nearest_point(const Vec3& at) const {
  std::size_t nearest = 0;
  double min_distance2 = std::numeric_limits<double>::infinity();
  // Double the cube until it contains the ball around `at` whose radius is the distance from `at` to the nearest point
  // found.
  for (double half = distance_to(shell_.bounds(), at) + grid_.cell_size(); min_distance2 > half * half; half *= 2.0) {
    for_each_near(grid_, at, half, [&](std::size_t i) {
      const double distance2 = (Vec3(grid_.x()[i], grid_.y()[i], grid_.z()[i]) - at).squaredNorm();
      if (distance2 >= min_distance2) return;
      min_distance2 = distance2;
      nearest = grid_.shell_indices()[i];
    });
  }
  return nearest;
}

SurfacePoint SmoothedSurface::nearest(const Vec3& at) const {
  const SurfacePoint start = shell_.point(nearest_point(at));
  SurfacePoint before = start, projection = start;
  for (int iteration = 0; iteration < kProjections; ++iteration) {
    // Average the neighbours of the last projection.
    double weights = 0.0;
    Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
    for_each_near(grid_, projection.position, radius_, [&](std::size_t i) {
      const SurfacePoint point = shell_.point(grid_.shell_indices()[i]);
      const double nearness = 1.0 - (point.position - projection.position).squaredNorm() / (radius_ * radius_);
      if (nearness <= 0.0 || point.normal.dot(start.normal) <= 0.0) return;
      const double weight = nearness * nearness;
      weights += weight;
      centre += weight * point.position;
      normal += weight * point.normal;
    });
    // Project `at` onto the plane through the centre of the neighbours.
    if (!(weights > 0.0)) return before;
    normal.normalize();
    centre /= weights;
    before = projection;
    projection = {at - normal.dot(at - centre) * normal, normal};
  }
  return projection;
}

/// Interpolates linearly between unit vectors and normalises the result.
static Vec3 between(const Vec3& a, const Vec3& b, double fraction) {
  return unit_or(a + fraction * (b - a), a);
}

static SurfacePoint between(const SurfacePoint& a, const SurfacePoint& b, double fraction) {
  return {a.position + fraction * (b.position - a.position), between(a.normal, b.normal, fraction)};
}

SurfacePath::SurfacePath(const SmoothedSurface& surface, std::span<const SurfacePoint> points)
    : radius_(surface.radius()), spacing_(spacing(radius_)), entries_{points.front()} {
  // Divide the path into intervals of equal length, which is at most SurfacePath::spacing().
  double total = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) total += (points[i].position - points[i - 1].position).norm();
  const auto intervals = static_cast<std::size_t>(std::ceil(total / spacing_));
  if (intervals > 0) spacing_ = total / static_cast<double>(intervals);
  // Interpolate entries along the polyline.
  double left = spacing_;  // distance along the path to the next entry [m]
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double leg = (points[i].position - points[i - 1].position).norm();
    double done = 0.0;
    for (; leg - done >= left && entries_.size() < intervals; left = spacing_) {
      done += left;
      entries_.push_back(between(points[i - 1], points[i], done / leg));
    }
    left -= leg - done;
  }
  entries_.resize(intervals + 1, points.back());
  // Store the surface's normals on the path and at positions on both sides of the path.
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const auto& [point, normal] = entries_[i];
    const Vec3 leftwards = normal.cross(direction(static_cast<double>(i) * spacing_));
    Normals& row = normals_.emplace_back();
    for (std::size_t k = 0; k < row.size(); ++k) {
      const double sideways = (static_cast<double>(k) - static_cast<double>(kSide)) * radius_;
      row[k] = k == kSide ? normal : surface.nearest(point + sideways * leftwards).normal;
    }
  }
}

SurfacePath SurfacePath::over(const SmoothedSurface& surface, std::span<const Vec3> points) {
  const double step = spacing(surface.radius());
  std::vector<SurfacePoint> projections = {surface.nearest(points.front())};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 leg = points[i] - points[i - 1];
    const double intervals = std::max(1.0, std::ceil(leg.norm() / step));
    for (double k = 1.0; k <= intervals; ++k)
      projections.push_back(surface.nearest(points[i - 1] + (k / intervals) * leg));
  }
  return {surface, projections};
}

/// Returns positions on the surface, about `step` [m] apart, on a path of `length` [m] that starts at `first` and
/// follows the unit vector `forward`. The path is shorter if it ends earlier (kMinProgress).
static std::vector<SurfacePoint> walk(const SmoothedSurface& surface, const SurfacePoint& first, const Vec3& forward,
                                      double length, double step) {
  std::vector<SurfacePoint> points = {first};
  for (double done = 0.0; done < length; done += step) {
    const SurfacePoint& here = points.back();
    const Vec3 within = forward - here.normal.dot(forward) * here.normal;
    if (within.norm() < kMinProgress) break;
    const SurfacePoint next = surface.nearest(here.position + step * within.normalized());
    if (forward.dot(next.position - here.position) < kMinProgress * kMinProgress * step) break;
    points.push_back(next);
  }
  return points;
}

SurfacePath SurfacePath::along(const SmoothedSurface& surface, const Vec3& start, const Vec3& direction,
                               double length) {
  const Vec3 forward = direction.normalized();
  const double step = spacing(surface.radius());
  const SurfacePoint first = surface.nearest(start);
  std::vector<SurfacePoint> points = walk(surface, first, forward, length, step);
  // The projection of a start far above a rough surface may lie off the surface. The first step then leads backwards,
  // and the path has one point only. In this case, project the start once more.
  if (points.size() == 1) points = walk(surface, surface.nearest(first.position), forward, length, step);
  return {surface, points};
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
  const auto& [point, normal] = between(entries_[before], entries_[after], fraction);
  const double sideways = normal.cross(direction(s)).dot(x - point) / radius_;
  const double column = std::clamp(sideways + static_cast<double>(kSide), 0.0, 2.0 * static_cast<double>(kSide));
  const auto right = std::min(static_cast<std::size_t>(column), 2 * kSide - 1);
  const auto across = [&](const Normals& row) {
    return between(row[right], row[right + 1], column - static_cast<double>(right));
  };
  return between(across(normals_[before]), across(normals_[after]), fraction);
}

Vec3 SurfacePath::direction(double s) const noexcept {
  const double here = std::clamp(s, 0.0, length());
  const Vec3 normal = at(here).normal;
  const Vec3 chord = at(here + radius_).position - at(here - radius_).position;
  const Vec3 within = chord - normal.dot(chord) * normal;
  const double norm = within.norm();
  return norm > 0.0 ? Vec3(within / norm) : normal.unitOrthogonal();
}

Vec3 DragHand::force(double t, const HandView& view) noexcept {
  const auto& [x, v] = view.handle;
  // Move `nearest_` by half the distance to the foot of the perpendicular on the path. This converges in a few steps;
  // moving the full distance would overshoot on curved paths.
  nearest_ += 0.5 * path_->direction(nearest_).dot(x - path_->at(nearest_).position);
  nearest_ = std::clamp(nearest_, 0.0, path_->length());
  find_progress(x, std::min(drag_.speed * t, path_->length()));
  const Vec3 n = normal_ = path_->normal_near(x, nearest_);

  const double s = drag_.speed * t;
  Vec3 pull = drag_.stiffness * (path_->at(s).position - x) - drag_.damping * v;
  if (s < path_->length()) pull += drag_.damping * drag_.speed * path_->direction(s);
  return pull - n.dot(pull) * n - (drag_.force(t) + drag_.normal_damping * n.dot(v)) * n;
}

/// Sets progress_ for the handle at x and the moving point at arc length s. Moves nearest_ to the leg of the moving
/// point if that leg is clearly nearer to the handle. This is necessary because nearest_ otherwise moves along the path
/// only, so it cannot change to another leg where the path turns back.
void DragHand::find_progress(const Vec3& x, double s) noexcept {
  const double on_leg = std::clamp(s + path_->direction(s).dot(x - path_->at(s).position), 0.0, s);
  const double distance = (x - path_->at(nearest_).position).norm(),
               distance_on_leg = (x - path_->at(on_leg).position).norm(), radius = path_->radius();
  if (distance_on_leg < distance - radius) nearest_ = on_leg;
  progress_ = distance_on_leg <= distance + SurfacePath::spacing(radius) ? on_leg : nearest_;
}

HandImpedance DragHand::impedance() const noexcept {
  const Mat3 along = normal_ * normal_.transpose(), across = Mat3::Identity() - along;
  return {drag_.stiffness * across, drag_.damping * across + drag_.normal_damping * along};
}

}  // namespace hapbench
