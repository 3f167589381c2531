#include "device_model/hands/surface_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

/// Sine of the angle between direction and normal below which there is no way on, and the share of a step that must be
/// made good along the direction: the place beyond an edge is that edge.
constexpr double kLeastProgress = 0.1;

SurfacePoint between(const SurfacePoint& a, const SurfacePoint& b, double fraction) {
  const Vec3 normal = a.normal + fraction * (b.normal - a.normal);
  const double norm = normal.norm();
  return {a.position + fraction * (b.position - a.position), norm > 0.0 ? Vec3(normal / norm) : a.normal};
}

}  // namespace

SurfacePath::SurfacePath(std::span<const SurfacePoint> places, double radius)
    : radius_(radius), spacing_(spacing(radius)), entries_{places.front()} {
  double left = spacing_;  // to the next entry
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double leg = (places[i].position - places[i - 1].position).norm();
    double done = 0.0;
    for (; leg - done >= left; left = spacing_) {
      done += left;
      entries_.push_back(between(places[i - 1], places[i], done / leg));
    }
    left -= leg - done;
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
  return {places, surface.radius()};
}

SurfacePath SurfacePath::along(const SmoothedSurface& surface, const Vec3& start, const Vec3& direction,
                               double length) {
  const Vec3 forward = direction.normalized();
  const double step = spacing(surface.radius());
  std::vector<SurfacePoint> places = {surface.nearest(start)};
  for (double done = 0.0; done < length; done += step) {
    const SurfacePoint& here = places.back();
    const Vec3 within = forward - here.normal.dot(forward) * here.normal;
    if (within.norm() < kLeastProgress) break;
    const SurfacePoint next = surface.nearest(here.position + step * within.normalized());
    if (forward.dot(next.position - here.position) < kLeastProgress * kLeastProgress * step) break;
    places.push_back(next);
  }
  return {places, surface.radius()};
}

SurfacePoint SurfacePath::at(double s) const noexcept {
  const double entry = std::clamp(s, 0.0, length()) / spacing_;
  const auto before = std::min(static_cast<std::size_t>(entry), entries_.size() - 1);
  const std::size_t after = std::min(before + 1, entries_.size() - 1);
  return between(entries_[before], entries_[after], entry - static_cast<double>(before));
}

Vec3 SurfacePath::direction(double s) const noexcept {
  const double here = std::clamp(s, 0.0, length());
  const Vec3 normal = at(here).normal;
  const Vec3 way = at(here + radius_).position - at(here - radius_).position;
  const Vec3 within = way - normal.dot(way) * normal;
  const double norm = within.norm();
  return norm > 0.0 ? Vec3(within / norm) : normal.unitOrthogonal();
}

}  // namespace hapbench
