#include "sim/tool/revolved.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "sim/tool/axial.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench {
namespace {

using simd::Mask, simd::Pack, simd::select;

/// Returns a mask of the points of `all` that lie in the part s <= 0 of the meridian's section. s: axial coordinate;
/// rho2: squared distance from the axis. Compares squared heights, because a square root costs as much as the tests of
/// four lines. This function and the tests below are always inlined: as function calls, which pass packs through
/// memory, they would make a simulation step with a bur 10 % slower.
[[gnu::always_inline]] inline Mask in_section(const Meridian& meridian, const Mask& all, const Pack& s,
                                              const Pack& rho2) {
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

/// Determines which points of a pack lie in the body, without the half ball of a round tip.
struct InProfile {
  const Meridian& meridian;
  Pack low, high, widest2;

  [[gnu::always_inline]] Mask operator()(const AxialPack& q) const {
    const Mask around = q.s >= low && q.s <= high && q.rho2 <= widest2;
    return simd::any(around) ? in_section(meridian, around, q.s, q.rho2) : around;
  }
};

/// Determines which points of a pack lie in a body with a round tip.
struct InProfileOrBall {
  InProfile in_profile;
  Pack ball2;

  [[gnu::always_inline]] Mask operator()(const AxialPack& q) const {
    return in_profile(q) || (q.s > Pack(0.0) && q.distance2() <= ball2);
  }
};

/// Returns the depth of points in a convex body's section, without the ball of a round tip: the distance to the
/// closest line. For a point outside, returns minus the largest distance to a half plane that does not contain the
/// point.
Pack convex_depth(const Meridian& meridian, const Pack& s, const Pack& rho) {
  Pack d = s - Pack(meridian.low);
  if (meridian.tip == Tip::flat) d = simd::min(d, Pack(meridian.high) - s);
  for (const HalfPlane& plane : meridian.planes) d = simd::min(d, plane.slack(s, rho));
  return d;
}

/// Closest point on the profile's segments and discs.
struct NearestPoint {
  Pack distance2;
  /// If the closest point is inside a segment: outward normal of the segment. If the closest point is a corner
  /// (`at_corner`): vector from the query point to the corner. Components along s and rho.
  Pack vs, vr;
  Mask at_corner;
};

/// Returns the closest point of the outline for points with axial coordinate s and distance rho from the axis.
[[gnu::always_inline]] inline NearestPoint nearest_point(const Meridian& meridian, const Pack& s, const Pack& rho) {
  const Pack zero(0.0);
  // At a distance [m] from a corner below this one, rounding dominates the direction to the corner. The normal of the
  // segment is then used, which is one of the valid directions.
  const Pack at_line(1e-12 * meridian.widest);
  NearestPoint nearest{Pack(std::numeric_limits<double>::infinity()), zero, zero, Pack(1.0) < zero};
  for (const Meridian::Line& line : meridian.lines) {
    const Pack ns(line.ns), nr(line.nr);
    const Pack inwards = line.slack(s, rho);
    const Pack along = nr * s - ns * rho - Pack(line.start);
    const Pack beyond = along - simd::max(zero, simd::min(along, Pack(line.length)));
    const Pack distance2 = inwards * inwards + beyond * beyond;
    const Mask nearer = distance2 < nearest.distance2;
    const Mask corner = simd::abs(beyond) > at_line;
    nearest.distance2 = simd::min(nearest.distance2, distance2);
    nearest.vs = select(nearer, select(corner, inwards * ns - beyond * nr, ns), nearest.vs);
    nearest.vr = select(nearer, select(corner, inwards * nr + beyond * ns, nr), nearest.vr);
    nearest.at_corner = (nearer && corner) || (nearest.at_corner && !nearer);
  }
  return nearest;
}

/// Returns the distance to the closest point of the outline. nearest_point() is inlined, so the compiler omits the
/// computation of its other results.
Pack nearest_distance(const Meridian& meridian, const Pack& s, const Pack& rho) {
  return simd::sqrt(nearest_point(meridian, s, rho).distance2);
}

/// Ray in axial coordinates, where d is the distance along the ray. Its points have the coordinate s + d slope along
/// the axis, and the radial vector rho + d u. The vectors rho and u are perpendicular to the axis.
struct AxialRay {
  double s, slope;
  Vec3 rho, u;
  double rho_length, u_length;
  double sine2;  ///< |u x rho|^2

  AxialRay(const ToolPose& pose, const Vec3& x, const Vec3& direction)
      : s(x.dot(pose.axis)),
        slope(direction.dot(pose.axis)),
        rho(x - s * pose.axis),
        u(direction - slope * pose.axis),
        rho_length(rho.norm()),
        u_length(u.norm()),
        sine2(u.cross(rho).squaredNorm()) {}
};

/// Intersections of a ray with the cone <n, (s, |rho|)> = offset. With k = offset - ns s and m = ns slope, the
/// distances d along the ray are the roots of
///
///   nr^2 |rho + d u|^2 = (k - m d)^2,   a d^2 + 2 b d + c = 0 with a = nr^2 |u|^2 - m^2, b = nr^2 <rho, u> + k m,
///   c = nr^2 |rho|^2 - k^2 and the discriminant b^2 - a c = nr^2 (|k u + m rho|^2 - nr^2 |u x rho|^2),
///
/// computed without cancellation near the axis and the cone.
struct ConeCrossing {
  double k, m, a, b, c, root;
  bool meets;  ///< true if the ray meets the cone; not read for a ray from inside a convex cone, which always meets it

  ConeCrossing(const HalfPlane& cone, const AxialRay& ray) : k(cone.offset - cone.ns * ray.s), m(cone.ns * ray.slope) {
    const double nr = cone.nr;
    a = (nr * ray.u_length - m) * (nr * ray.u_length + m);
    b = nr * nr * ray.rho.dot(ray.u) + k * m;
    c = (nr * ray.rho_length - k) * (nr * ray.rho_length + k);
    const double discriminant = (k * ray.u + m * ray.rho).squaredNorm() - nr * nr * ray.sine2;
    meets = discriminant >= 0.0;
    root = std::abs(nr) * std::sqrt(std::max(0.0, discriminant));
  }
};

/// Returns the distance at which the ray leaves the cone that the half plane describes. Precondition: the ray starts in
/// the cone, and the cone is convex.
double exit_of_convex(const HalfPlane& plane, const AxialRay& ray) {
  const double outwards = plane.ns * ray.slope + plane.nr * ray.u_length;  // rate of <n, (s, rho)> far along the ray
  if (outwards <= 0.0) return kNever;
  if (plane.nr == 0.0) return std::max(0.0, plane.slack(ray.s, 0.0) / outwards);
  const ConeCrossing q(plane, ray);
  const double c = std::min(0.0, q.c);
  if (q.b > 0.0) return -c / (q.b + q.root);
  return q.a > 0.0 ? (q.root - q.b) / q.a : 0.0;
}

/// Tolerances relative to the reach of the body. kAtStart: if the ray leaves the body at most this far before its
/// start, the start counts as a point on the surface. kAtEnd: an intersection at most this far beyond the end of a
/// segment counts as an intersection with the segment, so that no ray passes between two segments.
constexpr double kAtStart = 1e-12, kAtEnd = 1e-9;

/// Returns the distance to the first point where the ray leaves the body through the segment; kNever if there is no
/// such point.
double exit_through(const Meridian::Line& line, const AxialRay& ray, double reach) {
  const double at_start = kAtStart * reach, at_end = kAtEnd * reach;
  const auto on_line = [&](double d, double rho) {
    const double along = line.nr * (ray.s + d * ray.slope) - line.ns * rho - line.start;
    return d >= -at_start && along >= -at_end && along <= line.length + at_end;
  };
  if (line.nr == 0.0) {
    const double outwards = line.ns * ray.slope;
    if (outwards <= 0.0) return kNever;
    const double d = line.slack(ray.s, 0.0) / outwards;
    return on_line(d, (ray.rho + d * ray.u).norm()) ? std::max(0.0, d) : kNever;
  }
  const ConeCrossing q(line, ray);
  if (!q.meets) return kNever;
  // Test both roots; a root counts if it lies on the segment and the ray leaves the body there.
  const double sum = -(q.b + std::copysign(q.root, q.b));
  double first = kNever;
  for (const double d : {sum / q.a, q.c / sum}) {
    const double rho = (q.k - q.m * d) / line.nr;
    if (!(rho >= -at_start) || !on_line(d, rho)) continue;
    const double outwards = rho <= at_start ? q.m + line.nr * ray.u_length
                                            : q.m * rho + line.nr * (ray.rho.dot(ray.u) + d * ray.u.squaredNorm());
    if (outwards > 0.0) first = std::min(first, std::max(0.0, d));
  }
  return first;
}

/// Returns the distance to the point where the ray leaves through the half ball beyond the tip plane; kNever if there
/// is no such point.
double exit_through_ball(double radius, const Vec3& x, const Vec3& u, const AxialRay& ray, double reach) {
  const double b = x.dot(u), c = (radius - x.norm()) * (radius + x.norm());
  if (b * b + c < 0.0) return kNever;
  const double root = std::sqrt(b * b + c);
  const double d = b > 0.0 ? c / (b + root) : root - b;
  const bool there = d >= -kAtStart * reach && ray.s + d * ray.slope >= -kAtStart * reach;
  return there ? std::max(0.0, d) : kNever;
}

/// Returns the distance at which the ray from `point` along u first leaves the body; 0 if no exit is found.
double exit_distance(const Meridian& meridian, const ToolPose& pose, const Vec3& point, const Vec3& u) {
  const Vec3 x = point - pose.position;
  const AxialRay ray(pose, x, u);
  double d = kNever;
  for (const Meridian::Line& line : meridian.lines) {
    d = std::min(d, meridian.convex ? exit_of_convex(line, ray) : exit_through(line, ray, meridian.reach));
  }
  if (meridian.tip == Tip::round) d = std::min(d, exit_through_ball(meridian.ball, x, u, ray, meridian.reach));
  return d < kNever ? d : 0.0;
}

/// If the sine of the angle between a surface and a segment is below this number, the surface counts as parallel to the
/// segment: every point of the segment may then be a support point.
constexpr double kAlongLine = 1e-9;

/// Returns the unit vectors from the axis to the points, perpendicular to the axis even if the points are close to the
/// axis. For points whose bit in `defined` is not set, returns `any`.
PackVector away_from_axis(const AxialPack& q, const PackVector& axis, const Mask& defined, const PackVector& any) {
  const PackVector rho{q.rho_x, q.rho_y, q.rho_z};
  // Rounding of s gives a short radial vector a relatively large component along the axis; remove it.
  const PackVector across = combined(Pack(1.0), rho, -rho.dot(axis), axis);
  return unit_or(defined, across, simd::sqrt(across.dot(across)), any);
}

}  // namespace

Revolved::Revolved(std::vector<ProfilePoint> profile, Tip tip) : Revolved(Meridian(std::move(profile), tip)) {}

Revolved::Revolved(Meridian meridian)
    : ToolShape(meridian.widest, meridian.reach),
      meridian_(std::move(meridian)),
      widest2_(largest_square_within(meridian_.widest)),
      ball2_(largest_square_within(meridian_.ball)) {}

void Revolved::push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                           ContactBuffer& contacts) const noexcept {
  const InProfile in_profile{meridian_, Pack(meridian_.low), Pack(meridian_.high), Pack(widest2_)};
  if (meridian_.tip == Tip::flat) return push(pose, points, packs, contacts, in_profile);
  push(pose, points, packs, contacts, InProfileOrBall{in_profile, Pack(ball2_)});
}

void Revolved::mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept {
  const Meridian& m = meridian_;
  const bool round = m.tip == Tip::round;
  const Pack low(m.low - margin), high(std::max(m.high, m.ball) + margin), zero(0.0), within(margin);
  const Pack widest2((m.widest + margin) * (m.widest + margin)), ball2((m.ball + margin) * (m.ball + margin));
  mark(pose, points, ranges, marks, [&, round](const AxialPack& q) {
    const Mask around = q.s >= low && q.s <= high && q.rho2 <= widest2;
    if (!simd::any(around)) return around;
    const Pack rho = simd::sqrt(q.rho2);
    const Mask near_profile = m.convex ? convex_depth(m, q.s, rho) >= -within
                                       : in_section(m, around, q.s, q.rho2) || nearest_distance(m, q.s, rho) <= within;
    return round ? around && (near_profile || (q.s > zero && q.distance2() <= ball2)) : around && near_profile;
  });
}

Box Revolved::box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept {
  const AxisInterval whole{meridian_.low - margin, std::max(meridian_.high, meridian_.ball) + margin};
  const AxisInterval part = axis_interval_near(whole, pose, meridian_.widest + margin, bounds);
  // A point in `bounds` that is at most `margin` away from the body has its axial coordinate s in the interval `part`.
  // The closest point of the body has its axial coordinate within `margin` of this interval.
  double widest = part.high + margin >= 0.0 ? meridian_.ball : 0.0;
  for (std::size_t i = 0; i + 1 < meridian_.profile.size(); ++i) {
    const auto [a, b] = std::pair(meridian_.profile[i], meridian_.profile[i + 1]);
    const bool beside = std::max(a.s, b.s) >= part.low - margin && std::min(a.s, b.s) <= part.high + margin;
    if (beside) widest = std::max({widest, a.rho, b.rho});
  }
  return box_around(part, pose, widest + margin);
}

ToolShape::Cover Revolved::cover(double margin) const {
  const double length = std::max(meridian_.high, meridian_.ball) - meridian_.low + 2.0 * margin;
  return row_of_balls(meridian_.widest + margin, length);
}

std::vector<ProfilePoint> Revolved::outline() const {
  return closed_outline(profile(), tip());
}

void Revolved::shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  const Pack ball(meridian_.ball), zero(0.0);
  const bool convex = meridian_.convex, round = meridian_.tip == Tip::round;
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack rho = simd::sqrt(q.rho2);
    Pack d = convex ? convex_depth(meridian_, q.s, rho) : nearest_distance(meridian_, q.s, rho);
    if (round) d = select(q.s > zero, simd::min(d, ball - simd::sqrt(q.distance2())), d);
    // For a point in the half ball, rounding may make the depth below a segment that touches the ball negative.
    simd::store(simd::max(d, zero), &contacts.depth[i]);
  }
}

void Revolved::shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  const Pack ax(pose.axis.x()), ay(pose.axis.y()), az(pose.axis.z());
  const Pack ball(meridian_.ball), zero(0.0), one(1.0), sideways(1e-6);
  const Pack undefined_rho(kOnAxis * meridian_.widest), undefined_x(kOnAxis * meridian_.ball);
  const bool round = meridian_.tip == Tip::round;
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack rho = simd::sqrt(q.rho2);
    const NearestPoint nearest = nearest_point(meridian_, q.s, rho);
    // Normalise the direction to the closest point, and transform it from the axial half plane to the world frame.
    const Pack scale = one / simd::sqrt(nearest.vs * nearest.vs + nearest.vr * nearest.vr);
    const Pack vs = nearest.vs * scale, vr = nearest.vr * scale;
    const Mask on_axis = rho < undefined_rho;
    const Pack radial = select(on_axis, zero, vr / select(on_axis, one, rho));
    Pack x = vs * ax + radial * q.rho_x, y = vs * ay + radial * q.rho_y, z = vs * az + radial * q.rho_z;
    Mask undefined = on_axis && simd::abs(vr) > sideways;
    if (round) {
      const Pack from_centre = simd::sqrt(q.distance2());
      // If the round tip is closer than the profile, use the vector from the tip centre instead.
      const Pack to_ball = ball - from_centre;
      const Mask at_ball = q.s > zero && (to_ball <= zero || to_ball * to_ball <= nearest.distance2);
      x = select(at_ball, q.x, x);
      y = select(at_ball, q.y, y);
      z = select(at_ball, q.z, z);
      undefined = (at_ball && from_centre < undefined_x) || (undefined && !at_ball);
    }
    // Normalise again, because rounding of s gives a short radial vector a relatively large component along the
    // axis.
    const Pack length = simd::sqrt(x * x + y * y + z * z);
    const Pack unit = one / select(undefined, one, length);
    simd::store(select(undefined, -simd::load(&contacts.nx[i]), x * unit), &contacts.ux[i]);
    simd::store(select(undefined, -simd::load(&contacts.ny[i]), y * unit), &contacts.uy[i]);
    simd::store(select(undefined, -simd::load(&contacts.nz[i]), z * unit), &contacts.uz[i]);
  }
}

void Revolved::exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    exits[i] = exit_distance(meridian_, pose, contacts.point(i), contacts.gradient(i));
  }
}

void Revolved::surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                                   ContactBuffer& contacts) const noexcept {
  const Meridian& m = meridian_;
  const Pack low(m.low), high(m.high), ball(m.ball), zero(0.0), one(1.0), on_axis(kOnAxis * m.widest), flush(kFlush);
  const Pack in_reach(slack);
  const PackVector axis(pose.axis), any(pose.axis.unitOrthogonal()), move(wanted);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack rho = simd::sqrt(q.rho2);
    const PackVector out = away_from_axis(q, axis, rho > on_axis, any);
    const Pack from_centre = simd::sqrt(q.distance2());
    // Determine which points lie inside the body.
    const Mask in_tip = q.s > zero && from_centre <= ball;
    const Mask inside = in_section(m, q.s >= low && q.s <= high, q.s, q.rho2) || in_tip;

    // Compute the signed distance and the outward normal at the closest point of the outline.
    const NearestPoint nearest = nearest_point(m, q.s, rho);
    // Outside of the body, the vector to a corner is opposite to the normal.
    const Pack length = simd::sqrt(nearest.vs * nearest.vs + nearest.vr * nearest.vr);
    const Pack scale = select(nearest.at_corner && !inside, -one, one) / length;
    Pack distance = simd::sqrt(nearest.distance2);
    distance = select(inside, -distance, distance);
    PackVector normal = combined(nearest.vs * scale, axis, nearest.vr * scale, out);

    const PackVector surface(&contacts.nx[i], &contacts.ny[i], &contacts.nz[i]);
    // If the displacement `wanted` violates the constraint of a convex body, use instead the constraint of a face that
    // is flush with the surface.
    const Mask bumps = normal.dot(move) > distance;
    if (m.convex && simd::any(bumps)) {
      Pack furthest = -in_reach;
      for (const Meridian::Line& line : m.lines) {
        const Pack beyond = -line.slack(q.s, rho);
        const PackVector face = combined(Pack(line.ns), axis, Pack(line.nr), out);
        const Mask takes = bumps && beyond > furthest && -face.dot(surface) > flush;
        furthest = select(takes, beyond, furthest);
        distance = select(takes, beyond, distance);
        normal = select(takes, face, normal);
      }
    }
    if (m.tip == Tip::round) {
      const Pack beyond = from_centre - ball;
      const Mask at_ball = q.s > zero && beyond * beyond <= nearest.distance2;
      distance = select(at_ball, beyond, distance);
      normal = select(at_ball, unit_or(from_centre > zero, {q.x, q.y, q.z}, from_centre, axis), normal);
    }
    simd::store(-distance, &contacts.depth[i]);
    normal.store(&contacts.ux[i], &contacts.uy[i], &contacts.uz[i]);
  }
  contacts.pad();
}

void Revolved::support_points(const ToolPose& pose, const ContactBuffer& contacts,
                              const MutablePointArrays& surface_points) const noexcept {
  const Meridian& m = meridian_;
  const Pack zero(0.0), one(1.0), along_line(kAlongLine), ball(m.ball);
  const PackVector position(pose.position), axis(pose.axis);
  // If the surface is perpendicular to the axis, every point of a rim (the circle of a profile's corner) is a support
  // point. Use the centre of the rim for a convex body, and any point of the rim otherwise.
  const PackVector none(m.convex ? Vec3(Vec3::Zero()) : pose.axis.unitOrthogonal());
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const PackVector n(&contacts.nx[i], &contacts.ny[i], &contacts.nz[i]);
    const Pack forward = -n.dot(axis);
    const PackVector across = combined(-one, n, -forward, axis);
    const Pack outward = simd::sqrt(across.dot(across));
    const PackVector out = unit_or(outward > zero, across, outward, none);

    // Find the corner of the profile that is farthest ahead, in the direction -n.
    Pack best(-std::numeric_limits<double>::infinity()), s = zero, rho = zero;
    for (const ProfilePoint& p : m.profile) {
      const Pack ahead = forward * Pack(p.s) + outward * Pack(p.rho);
      const Mask further = ahead > best;
      best = select(further, ahead, best);
      s = select(further, Pack(p.s), s);
      rho = select(further, Pack(p.rho), rho);
    }
    const Pack enough = best - Pack(2.0 * kAlongLine * m.reach);
    // If the surface is parallel to a segment that is farthest ahead, every point of the segment is a support point:
    // use the point closest to the contact.
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack beside = q.rho_x * out.x + q.rho_y * out.y + q.rho_z * out.z;
    Pack aside2(std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k + 1 < m.profile.size(); ++k) {
      const Meridian::Line& line = m.lines[k];
      const Pack us(line.nr), ur(-line.ns), a(m.profile[k].s), b(m.profile[k].rho);
      const Pack along = simd::max(zero, simd::min(us * q.s + ur * beside - Pack(line.start), Pack(line.length)));
      const Pack there_s = a + along * us, there_rho = b + along * ur;
      const Pack off_s = q.s - there_s, off_rho = beside - there_rho, off2 = off_s * off_s + off_rho * off_rho;
      const Mask foremost = simd::abs(forward * us + outward * ur) < along_line && forward * a + outward * b >= enough;
      const Mask takes = foremost && outward > zero && off2 < aside2;
      aside2 = select(takes, off2, aside2);
      s = select(takes, there_s, s);
      rho = select(takes, there_rho, rho);
    }
    // A point of the round tip may be farther ahead than every corner.
    const Mask at_ball = m.tip == Tip::round ? forward > along_line && ball >= best : zero > one;
    simd::store(select(at_ball, -ball * n.x, s * axis.x + rho * out.x) + position.x, &surface_points.x[i]);
    simd::store(select(at_ball, -ball * n.y, s * axis.y + rho * out.y) + position.y, &surface_points.y[i]);
    simd::store(select(at_ball, -ball * n.z, s * axis.z + rho * out.z) + position.z, &surface_points.z[i]);
  }
}

ToolShape::Grown Revolved::grown(double margin) const {
  const bool round = tip() == Tip::round && meridian_.widest <= meridian_.ball;
  std::vector<ProfilePoint> corners;
  const auto add_square = [&](double s, double rho) {
    corners.push_back({s - margin, rho + margin});
    if (!round) corners.push_back({s + margin, rho + margin});
  };
  for (const ProfilePoint& p : profile()) add_square(p.s, p.rho);
  // If the tip stays round, the front corners of the squares are omitted. No part of the body is then wider than the
  // ball, so the rear corners and the corner added here still enclose everything behind the ball's centre.
  if (round) corners.push_back({0.0, meridian_.ball + margin});
  if (!round && tip() == Tip::round) add_square(meridian_.ball, meridian_.ball);

  std::sort(corners.begin(), corners.end(),
            [](const ProfilePoint& a, const ProfilePoint& b) { return a.s < b.s || (a.s == b.s && a.rho < b.rho); });
  // Compute the upper convex hull of the corners.
  std::vector<ProfilePoint> hull;
  for (const ProfilePoint& p : corners) {
    // If several corners have the same s, keep the corner with the largest rho.
    while (!hull.empty() && hull.back().s == p.s) hull.pop_back();
    while (hull.size() >= 2 && cross(hull[hull.size() - 2], hull.back(), p) >= 0.0) hull.pop_back();
    hull.push_back(p);
  }
  // Move the tip centre of the hull to s = 0.
  const double forward = hull.back().s;
  for (ProfilePoint& p : hull) p.s -= forward;
  return {std::make_unique<Revolved>(std::move(hull), round ? Tip::round : Tip::flat), forward};
}

}  // namespace hapbench
