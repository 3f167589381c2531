#include "sim/geometry/analytic_shells.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Returns the number of equal intervals into which a length is divided, so that none is longer than the spacing. The
/// term 1e-9 covers rounding if the length is a multiple of the spacing.
double intervals(double length, double spacing) {
  return std::max(1.0, std::ceil(length / spacing - 1e-9));
}

/// Returns point number k of n + 1 equally spaced points from a to b; exact at both ends.
double between(double a, double b, double k, double n) {
  return k == n ? b : a + (b - a) * (k / n);
}

/// Adds the points of the profile's edge from a to b, but not a and b themselves.
void add_face(std::vector<SurfacePoint>& points, const Vec3& a, const Vec3& b, const Vec3& normal, double spacing) {
  const double n = intervals((b - a).norm(), spacing);
  for (double k = 1; k < n; ++k) {
    points.push_back({{between(a.x(), b.x(), k, n), between(a.y(), b.y(), k, n), 0.0}, normal});
  }
}

double length(double a, double b) {
  return std::sqrt(a * a + b * b);
}

/// Returns the length of the cone's wall from apex to mouth [m].
double slant(const ConicalHole& cone) {
  return cone.depth / math::cos(cone.half_angle);
}

}  // namespace

double point_count(const Hole2d& h) {
  return 2 * intervals(h.mouth, h.spacing) + 2 * intervals(h.depth, h.spacing) + intervals(h.width, h.spacing) + 1;
}

std::vector<SurfacePoint> surface_points(const Hole2d& h) {
  const double half = h.width / 2;
  const Vec3 up(0, 1, 0), right(1, 0, 0), left(-1, 0, 0);
  // Corners of the profile from left to right, and the normal of the edge that starts at each corner.
  const std::vector<Vec3> corners = {{-half - h.mouth, 0, 0}, {-half, 0, 0}, {-half, -h.depth, 0},
                                     {half, -h.depth, 0},     {half, 0, 0},  {half + h.mouth, 0, 0}};
  const std::vector<Vec3> faces = {up, right, up, left, up};

  std::vector<SurfacePoint> points;
  points.push_back({corners.front(), up});
  for (std::size_t i = 0; i < faces.size(); ++i) {
    add_face(points, corners[i], corners[i + 1], faces[i], h.spacing);
    const bool last = i + 1 == faces.size();
    points.push_back({corners[i + 1], last ? up : Vec3((faces[i] + faces[i + 1]).normalized())});
  }
  return points;
}

double point_count(const Plane& plane) {
  const double n = intervals(plane.size, plane.spacing) + 1;
  return n * n;
}

std::vector<SurfacePoint> surface_points(const Plane& plane) {
  const double n = intervals(plane.size, plane.spacing);
  const double half = plane.size / 2;
  std::vector<SurfacePoint> points;
  points.reserve(static_cast<std::size_t>(point_count(plane)));
  for (double i = 0; i <= n; ++i) {
    for (double j = 0; j <= n; ++j) {
      points.push_back({{between(-half, half, i, n), between(-half, half, j, n), 0.0}, {0, 0, 1}});
    }
  }
  return points;
}

double point_count(const Slot& slot) {
  return 2 * (intervals(slot.length, slot.spacing) + 1) * (intervals(slot.depth, slot.spacing) + 1);
}

std::vector<SurfacePoint> surface_points(const Slot& slot) {
  const double ny = intervals(slot.length, slot.spacing);
  const double nz = intervals(slot.depth, slot.spacing);
  std::vector<SurfacePoint> points;
  points.reserve(static_cast<std::size_t>(point_count(slot)));
  for (const double side : {-1.0, 1.0}) {
    for (double j = 0; j <= ny; ++j) {
      for (double k = 0; k <= nz; ++k) {
        const double y = between(-slot.length / 2, slot.length / 2, j, ny);
        points.push_back({{side * slot.gap / 2, y, between(-slot.depth, 0.0, k, nz)}, {-side, 0, 0}});
      }
    }
  }
  return points;
}

/// Returns an upper bound of the number of points: the sum of the rings' circumferences divided by the spacing, plus
/// four points per ring for rounding up to a multiple of four.
double point_count(const ConicalHole& cone) {
  const double rings = intervals(slant(cone), cone.spacing);
  const double mouth = math::sin(cone.half_angle) * slant(cone);
  return 1.0 + rings * (4.0 + std::numbers::pi * mouth * (1.0 + 1.0 / rings) / cone.spacing);
}

std::vector<SurfacePoint> surface_points(const ConicalHole& cone) {
  const double sine = math::sin(cone.half_angle), cosine = math::cos(cone.half_angle);
  const double length = slant(cone), rings = intervals(length, cone.spacing);
  std::vector<SurfacePoint> points = {{{0, 0, -cone.depth}, {0, 0, 1}}};
  for (double k = 1; k <= rings; ++k) {
    const double along = between(0.0, length, k, rings);
    const double radius = along * sine, z = k == rings ? 0.0 : along * cosine - cone.depth;
    const double quarter = intervals(std::numbers::pi / 2 * radius, cone.spacing);
    for (double i = 0; i < quarter; ++i) {
      // Compute a point in the first quadrant. Its rotations by 90, 180 and 270 degrees use the same cosine and sine,
      // so that the four points agree bit for bit.
      const double angle = (i + 0.5) / quarter * std::numbers::pi / 2;
      const double c = math::cos(angle), s = math::sin(angle);
      for (const auto& [x, y] : {std::pair(c, s), std::pair(-s, c), std::pair(-c, -s), std::pair(s, -c)}) {
        points.push_back({{radius * x, radius * y, z}, {-cosine * x, -cosine * y, sine}});
      }
    }
  }
  return points;
}

double signed_distance(const Plane&, const Vec3& q) {
  return q.z();
}

double signed_distance(const Slot& slot, const Vec3& q) {
  return slot.gap / 2 - std::abs(q.x());
}

double signed_distance(const Hole2d& hole, const Vec3& q) {
  const double out = std::abs(q.x()) - hole.width / 2, below = -hole.depth - q.y();
  // Above the top: the distance to the flat top or to the closest rim.
  if (q.y() >= 0.0) return out >= 0.0 ? q.y() : length(out, q.y());
  // In the hole: distance to the closest wall or the bottom.
  if (out < 0.0 && below < 0.0) return -std::max(out, below);
  // In the material: distance to the hole or to the top.
  const double to_hole = length(std::max(out, 0.0), std::max(below, 0.0));
  return -(out >= 0.0 ? std::min(-q.y(), to_hole) : to_hole);
}

double signed_distance(const ConicalHole& cone, const Vec3& q) {
  const double sine = math::sin(cone.half_angle), cosine = math::cos(cone.half_angle);
  const double rho = length(q.x(), q.y()), z = q.z() + cone.depth;  // coordinates relative to the apex
  const double inwards = sine * z - cosine * rho;
  const double along = sine * rho + cosine * z, beyond = along - std::clamp(along, 0.0, slant(cone));
  return std::copysign(length(inwards, beyond), inwards);
}

double signed_distance(const BlockWithHole& block, const Vec3& q) {
  const double R = block.hole_diameter / 2, H = block.hole_depth, z = q.z();
  // Signed distances from the side faces and from the bottom face, positive outside of the cuboid.
  const double x = std::abs(q.x()) - block.size.x() / 2, y = std::abs(q.y()) - block.size.y() / 2;
  const double below = -z - block.size.z();
  const double rho = length(q.x(), q.y());

  // Outside of the cuboid.
  if (std::max({x, y, z, below}) > 0.0) {
    // Above the mouth of the hole, the closest point is on the rim of the hole.
    if (rho < R && z > 0.0) return length(z, R - rho);
    const double beyond_sides = length(std::max(x, 0.0), std::max(y, 0.0));
    return length(beyond_sides, std::max({z, below, 0.0}));
  }
  if (rho < R && z > -H) return std::min(R - rho, z + H);  // in the hole: distance to its wall or bottom
  // In the material: distance to the closest face or to the hole.
  const double to_hole = length(std::max(rho - R, 0.0), std::max(-H - z, 0.0));
  return -std::min({-x, -y, -z, -below, to_hole});
}

}  // namespace hapbench
