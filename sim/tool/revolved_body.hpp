#pragma once

#include <limits>

#include "sim/tool/axial.hpp"
#include "sim/tool/meridian.hpp"

/// Eight points against a meridian. For source files only (see simd.hpp).
namespace hapbench {

inline simd::Pack slack(const HalfPlane& plane, const simd::Pack& s, const simd::Pack& rho) {
  return simd::Pack(plane.offset) - simd::Pack(plane.ns) * s - simd::Pack(plane.nr) * rho;
}

/// Which points with axial coordinate s and squared distance from the axis rho2 lie in the section with s <= 0, as far
/// as `all` are asked for. Squares of heights, since a root costs as much as four lines.
inline simd::Mask in_section(const Meridian& meridian, const simd::Mask& all, const simd::Pack& s,
                             const simd::Pack& rho2) {
  using simd::Mask, simd::Pack;
  const auto height = [&](std::size_t k) {
    return Pack(meridian.heights[k].at_tip) + Pack(meridian.heights[k].slope) * s;
  };
  Mask in = all && !all;
  for (const Meridian::Part& part : meridian.parts) {
    Mask here = all && s >= Pack(part.low) && s <= Pack(part.high);
    if (!simd::any(here)) continue;
    const std::size_t end = part.above_last ? part.last - 1 : part.last;
    Pack below = height(part.first);
    for (std::size_t k = part.first + 1; k < end; ++k) below = simd::min(below, height(k));
    here = here && rho2 <= below * below;
    if (part.above_last) here = here && rho2 >= height(end) * height(end);
    in = in || here;
  }
  return in;
}

/// Of points in a convex body's section behind a round tip, or in a flat one's: the distance to the surface, which is
/// that to the nearest of the lines. Negative by as much as a point misses the worst of the half planes.
inline simd::Pack convex_depth(const Meridian& meridian, const simd::Pack& s, const simd::Pack& rho) {
  using simd::Pack;
  Pack d = s - Pack(meridian.low);
  if (meridian.tip == Tip::flat) d = simd::min(d, Pack(meridian.high) - s);
  for (const HalfPlane& plane : meridian.planes) d = simd::min(d, slack(plane, s, rho));
  return d;
}

/// The place of the profile's lines and discs that is nearest to a point.
struct NearestPlace {
  simd::Pack distance2;
  simd::Pack vs, vr;  ///< the normal of the line it lies on; at a corner the vector from the point to it
  simd::Mask at_corner;
};

inline NearestPlace nearest_place(const Meridian& meridian, const simd::Pack& s, const simd::Pack& rho) {
  using simd::Mask, simd::Pack, simd::select;
  const Pack zero(0.0);
  // A point this near to a corner has no direction to it but rounding; the line's normal is one of those it could have.
  const Pack at_line(1e-12 * meridian.widest);
  NearestPlace nearest{Pack(std::numeric_limits<double>::infinity()), zero, zero, zero < zero};
  for (const Meridian::Line& line : meridian.lines) {
    const Pack ns(line.ns), nr(line.nr);
    const Pack inwards = slack(line, s, rho);
    const Pack along = nr * s - ns * rho - Pack(line.start);
    const Pack beyond = along - simd::max(zero, simd::min(along, Pack(line.length)));
    const Pack distance2 = inwards * inwards + beyond * beyond;
    const Mask nearer = distance2 < nearest.distance2;
    const Mask corner = simd::abs(beyond) > at_line;
    nearest.distance2 = select(nearer, distance2, nearest.distance2);
    nearest.vs = select(nearer, select(corner, inwards * ns - beyond * nr, ns), nearest.vs);
    nearest.vr = select(nearer, select(corner, inwards * nr + beyond * ns, nr), nearest.vr);
    nearest.at_corner = (nearer && corner) || (nearest.at_corner && !nearer);
  }
  return nearest;
}

/// Distance to them alone.
inline simd::Pack nearest_distance(const Meridian& meridian, const simd::Pack& s, const simd::Pack& rho) {
  using simd::Pack;
  const Pack zero(0.0);
  Pack nearest2(std::numeric_limits<double>::infinity());
  for (const Meridian::Line& line : meridian.lines) {
    const Pack inwards = slack(line, s, rho);
    const Pack along = Pack(line.nr) * s - Pack(line.ns) * rho - Pack(line.start);
    const Pack beyond = along - simd::max(zero, simd::min(along, Pack(line.length)));
    nearest2 = simd::min(nearest2, inwards * inwards + beyond * beyond);
  }
  return simd::sqrt(nearest2);
}

}  // namespace hapbench
