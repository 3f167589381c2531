#include "sim/geometry/block_with_hole.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

/// Distance to a rectangle in the plane where `across` is zero: the other two coordinates beyond half extents a and b.
double to_rectangle(double across, double u, double a, double v, double b) {
  return std::hypot(across, std::max(0.0, std::abs(u) - a), std::max(0.0, std::abs(v) - b));
}

}  // namespace

double signed_distance(const BlockWithHole& block, const Vec3& q) {
  const double a = block.size.x() / 2, b = block.size.y() / 2, c = block.size.z() / 2;
  const double R = block.hole_diameter / 2, H = block.hole_depth;
  const double x = q.x(), y = q.y(), z = q.z(), middle = z + c;
  const double rho = std::hypot(x, y);

  // The surface in pieces, each an exact distance: four sides, bottom, top without the mouth, wall and bottom of the
  // hole.
  double d = std::min({to_rectangle(x - a, y, b, middle, c), to_rectangle(x + a, y, b, middle, c),
                       to_rectangle(y - b, x, a, middle, c), to_rectangle(y + b, x, a, middle, c),
                       to_rectangle(z + 2 * c, x, a, y, b)});
  // Above or below the mouth the nearest point of the top face is on the rim.
  d = std::min(d, rho < R ? std::hypot(z, R - rho) : to_rectangle(z, x, a, y, b));
  d = std::min(d, std::hypot(rho - R, std::max(0.0, z), std::max(0.0, -H - z)));
  d = std::min(d, std::hypot(z + H, std::max(0.0, rho - R)));

  const bool in_box = std::abs(x) <= a && std::abs(y) <= b && std::abs(middle) <= c;
  const bool in_hole = rho < R && z > -H;
  return in_box && !in_hole ? -d : d;
}

}  // namespace hapbench
