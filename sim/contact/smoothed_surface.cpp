#include "sim/contact/smoothed_surface.hpp"

#include <limits>

namespace hapbench {
namespace {

constexpr int kPasses = 3;

Box box_around(const Vec3& centre, double half) {
  return {centre - Vec3::Constant(half), centre + Vec3::Constant(half)};
}

}  // namespace

SmoothedSurface::SmoothedSurface(const PointShell& shell, double radius)
    : shell_(shell), grid_(shell), radius_(radius) {}

std::size_t SmoothedSurface::nearest_point(const Vec3& at) const {
  std::size_t nearest = 0;
  double least2 = std::numeric_limits<double>::infinity();
  // Ends when the box contains the whole ball around `at` that has the nearest point found on its surface.
  for (double half = distance_to(grid_.bounds(), at) + grid_.cell_size(); least2 > half * half; half *= 2.0) {
    grid_.for_each_run(box_around(at, half), [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const double distance2 = (Vec3(grid_.x()[i], grid_.y()[i], grid_.z()[i]) - at).squaredNorm();
        if (distance2 >= least2) continue;
        least2 = distance2;
        nearest = grid_.shell_index(i);
      }
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
    grid_.for_each_run(box_around(place.position, radius_), [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const SurfacePoint point = shell_.point(grid_.shell_index(i));
        const double nearness = 1.0 - (point.position - place.position).squaredNorm() / (radius_ * radius_);
        if (nearness <= 0.0 || point.normal.dot(start.normal) <= 0.0) continue;
        const double weight = nearness * nearness;
        weights += weight;
        centre += weight * point.position;
        normal += weight * point.normal;
      }
    });
    if (!(weights > 0.0)) return before;
    normal.normalize();
    centre /= weights;
    before = place;
    place = {at - normal.dot(at - centre) * normal, normal};
  }
  return place;
}

}  // namespace hapbench
