#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/tool/revolved.hpp"
#include "sim/tool/revolved_body.hpp"

/// What depth models ask of a solid of revolution.
namespace hapbench {
namespace {

using simd::Mask, simd::Pack, simd::select;

/// A ray x + d u in axial coordinates: s + d slope along the axis and the vector rho + d u across it.
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

/// Where a ray meets the cone <n, (s, |rho|)> = offset: with k = offset - ns s and m = ns slope, in the roots of
///
///   nr^2 |rho + d u|^2 = (k - m d)^2,   a d^2 + 2 b d + c = 0 with a = nr^2 |u|^2 - m^2, b = nr^2 <rho, u> + k m,
///   c = nr^2 |rho|^2 - k^2 and the discriminant b^2 - a c = nr^2 (|k u + m rho|^2 - nr^2 |u x rho|^2),
///
/// written so that nothing cancels near the axis or the cone.
struct ConeCrossing {
  double k, m, a, b, c, root;
  bool meets;  ///< a ray from within a convex cone does, whatever rounding says

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

/// Where the ray from a point in the half plane's cone, a convex set, leaves it.
double exit_of_convex(const HalfPlane& plane, const AxialRay& ray) {
  const double outwards = plane.ns * ray.slope + plane.nr * ray.u_length;  // in the long run
  if (outwards <= 0.0) return kNever;
  if (plane.nr == 0.0) return std::max(0.0, plane.slack(ray.s, 0.0) / outwards);
  const ConeCrossing q(plane, ray);
  const double c = std::min(0.0, q.c);
  if (q.b > 0.0) return -c / (q.b + q.root);
  return q.a > 0.0 ? (q.root - q.b) / q.a : 0.0;
}

/// Relative to the reach: nearer behind its start, a ray that goes out starts on the surface; nearer to a line's end,
/// it meets the line, so that none slips through between two.
constexpr double kAtStart = 1e-12, kAtEnd = 1e-9;

/// Where the ray first goes out through the line.
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

/// Where the ray goes out through the half ball beyond the tip plane.
double exit_through_ball(double radius, const Vec3& x, const Vec3& u, const AxialRay& ray, double reach) {
  const double b = x.dot(u), c = (radius - x.norm()) * (radius + x.norm());
  if (b * b + c < 0.0) return kNever;
  const double root = std::sqrt(b * b + c);
  const double d = b > 0.0 ? c / (b + root) : root - b;
  const bool there = d >= -kAtStart * reach && ray.s + d * ray.slope >= -kAtStart * reach;
  return there ? std::max(0.0, d) : kNever;
}

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

}  // namespace

void Revolved::shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  const Pack ball(meridian_.ball), zero(0.0);
  const bool convex = meridian_.convex, round = meridian_.tip == Tip::round;
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack rho = simd::sqrt(q.rho2);
    Pack d = convex ? convex_depth(meridian_, q.s, rho) : nearest_distance(meridian_, q.s, rho);
    if (round) d = select(q.s > zero, simd::min(d, ball - simd::sqrt(q.distance2())), d);
    // In the ball, lines that touch it may be missed by a rounding.
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
    const NearestPlace nearest = nearest_place(meridian_, q.s, rho);
    const Pack scale = one / simd::sqrt(nearest.vs * nearest.vs + nearest.vr * nearest.vr);
    const Pack vs = nearest.vs * scale, vr = nearest.vr * scale;
    const Mask on_axis = rho < undefined_rho;
    const Pack radial = select(on_axis, zero, vr / select(on_axis, one, rho));
    Pack x = vs * ax + radial * q.rho_x, y = vs * ay + radial * q.rho_y, z = vs * az + radial * q.rho_z;
    Mask undefined = on_axis && simd::abs(vr) > sideways;
    if (round) {
      const Pack from_centre = simd::sqrt(q.distance2());
      const Pack to_ball = ball - from_centre;
      const Mask at_ball = q.s > zero && (to_ball <= zero || to_ball * to_ball <= nearest.distance2);
      x = select(at_ball, q.x, x);
      y = select(at_ball, q.y, y);
      z = select(at_ball, q.z, z);
      undefined = (at_ball && from_centre < undefined_x) || (undefined && !at_ball);
    }
    // The radial vector is square to the axis up to a rounding of s, which is large beside a small rho.
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

}  // namespace hapbench
