#include "sim/geometry/block_with_hole.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

double length(double a, double b) {
  return std::sqrt(a * a + b * b);
}

}  // namespace

double signed_distance(const BlockWithHole& block, const Vec3& q) {
  const double R = block.hole_diameter / 2, H = block.hole_depth, z = q.z();
  // Beyond the faces; negative between them.
  const double x = std::abs(q.x()) - block.size.x() / 2, y = std::abs(q.y()) - block.size.y() / 2;
  const double below = -z - block.size.z();
  const double rho = length(q.x(), q.y());

  if (std::max({x, y, z, below}) > 0.0) {
    // Above the mouth the nearest point of the top face is on the rim.
    if (rho < R && z > 0.0) return length(z, R - rho);
    const double beyond_sides = length(std::max(x, 0.0), std::max(y, 0.0));
    return length(beyond_sides, std::max({z, below, 0.0}));
  }
  if (rho < R && z > -H) return std::min(R - rho, z + H);  // in the hole: to its wall or bottom
  const double to_hole = length(std::max(rho - R, 0.0), std::max(-H - z, 0.0));
  return -std::min({-x, -y, -z, -below, to_hole});
}

}  // namespace hapbench
