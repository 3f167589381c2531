#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "sim/tool/revolved.hpp"
#include "sim/tool/revolved_body.hpp"

/// What a proxy asks of a solid of revolution.
namespace hapbench {
namespace {

using simd::Mask, simd::Pack, simd::select;

/// Sine of the angle to a line below which a surface runs along it, so that none of its ends comes first.
constexpr double kAlongLine = 1e-9;

struct PackVector {
  Pack x, y, z;

  explicit PackVector(const Vec3& v) : x(v.x()), y(v.y()), z(v.z()) {}
  PackVector(const Pack& px, const Pack& py, const Pack& pz) : x(px), y(py), z(pz) {}

  Pack dot(const PackVector& o) const { return x * o.x + y * o.y + z * o.z; }
};

PackVector chosen(const Mask& mask, const PackVector& yes, const PackVector& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}

/// a p + b q.
PackVector combined(const Pack& a, const PackVector& p, const Pack& b, const PackVector& q) {
  return {a * p.x + b * q.x, a * p.y + b * q.y, a * p.z + b * q.z};
}

/// v / length where `defined`, else `other`.
PackVector unit_or(const Mask& defined, const PackVector& v, const Pack& length, const PackVector& other) {
  const Pack scale = Pack(1.0) / select(defined, length, Pack(1.0));
  return chosen(defined, {v.x * scale, v.y * scale, v.z * scale}, other);
}

/// The unit vector from the axis to the points, square to the axis however near they are, and `any` where undefined.
PackVector away_from_axis(const AxialPack& q, const PackVector& axis, const Mask& defined, const PackVector& any) {
  const PackVector rho{q.rho_x, q.rho_y, q.rho_z};
  // The radial vector is square to it up to a rounding of s only, which is large beside a small rho.
  const PackVector square = combined(Pack(1.0), rho, -rho.dot(axis), axis);
  return unit_or(defined, square, simd::sqrt(square.dot(square)), any);
}

}  // namespace

void Revolved::surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack_wanted,
                                   ContactBuffer& contacts) const noexcept {
  const Meridian& m = meridian_;
  const Pack low(m.low), high(m.high), ball(m.ball), zero(0.0), one(1.0), on_axis(kOnAxis * m.widest), flush(kFlush);
  const Pack in_reach(slack_wanted);
  const PackVector axis(pose.axis), any(pose.axis.unitOrthogonal()), move(wanted);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack rho = simd::sqrt(q.rho2);
    const PackVector out = away_from_axis(q, axis, rho > on_axis, any);
    const Pack from_centre = simd::sqrt(q.distance2());
    const Mask in_tip = q.s > zero && from_centre <= ball;
    const Mask inside = in_section(m, q.s >= low && q.s <= high, q.s, q.rho2) || in_tip;

    const NearestPlace nearest = nearest_place(m, q.s, rho);
    // Seen from outside, a corner lies against the normal.
    const Pack length = simd::sqrt(nearest.vs * nearest.vs + nearest.vr * nearest.vr);
    const Pack scale = select(nearest.at_corner && !inside, -one, one) / length;
    Pack distance = simd::sqrt(nearest.distance2);
    distance = select(inside, -distance, distance);
    PackVector normal = combined(nearest.vs * scale, axis, nearest.vr * scale, out);

    const PackVector surface{simd::load(&contacts.nx[i]), simd::load(&contacts.ny[i]), simd::load(&contacts.nz[i])};
    const Mask bumps = normal.dot(move) > distance;
    if (m.convex && simd::any(bumps)) {
      Pack furthest = -in_reach;
      for (const Meridian::Line& line : m.lines) {
        const Pack beyond = -slack(line, q.s, rho);
        const PackVector face = combined(Pack(line.ns), axis, Pack(line.nr), out);
        const Mask takes = bumps && beyond > furthest && -face.dot(surface) > flush;
        furthest = select(takes, beyond, furthest);
        distance = select(takes, beyond, distance);
        normal = chosen(takes, face, normal);
      }
    }
    if (m.tip == Tip::round) {
      const Pack beyond = from_centre - ball;
      const Mask at_ball = q.s > zero && beyond * beyond <= nearest.distance2;
      distance = select(at_ball, beyond, distance);
      normal = chosen(at_ball, unit_or(from_centre > zero, {q.x, q.y, q.z}, from_centre, axis), normal);
    }
    simd::store(-distance, &contacts.depth[i]);
    simd::store(normal.x, &contacts.ux[i]);
    simd::store(normal.y, &contacts.uy[i]);
    simd::store(normal.z, &contacts.uz[i]);
  }
  contacts.pad();
}

void Revolved::foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                               const PlaceArrays& places) const noexcept {
  const Meridian& m = meridian_;
  const Pack zero(0.0), one(1.0), along_line(kAlongLine), ball(m.ball);
  const PackVector position(pose.position), axis(pose.axis);
  // Where the surface is square to the axis any place of a rim is foremost, and of a convex body the rim's centre, too.
  const PackVector none(m.convex ? Vec3(Vec3::Zero()) : pose.axis.unitOrthogonal());
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const PackVector n{simd::load(&contacts.nx[i]), simd::load(&contacts.ny[i]), simd::load(&contacts.nz[i])};
    const Pack forward = -n.dot(axis);
    const PackVector across = combined(-one, n, -forward, axis);
    const Pack outward = simd::sqrt(across.dot(across));
    const PackVector out = unit_or(outward > zero, across, outward, none);

    Pack best(-std::numeric_limits<double>::infinity()), s = zero, rho = zero;
    for (const ProfilePoint& p : m.profile) {
      const Pack ahead = forward * Pack(p.s) + outward * Pack(p.rho);
      const Mask further = ahead > best;
      best = select(further, ahead, best);
      s = select(further, Pack(p.s), s);
      rho = select(further, Pack(p.rho), rho);
    }
    const Pack enough = best - Pack(2.0 * kAlongLine * m.reach);
    // Of lines that the surface runs along every place is foremost: the one abreast of the contact.
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
    const Mask at_ball = m.tip == Tip::round ? forward > along_line && ball >= best : zero > one;
    simd::store(select(at_ball, -ball * n.x, s * axis.x + rho * out.x) + position.x, &places.x[i]);
    simd::store(select(at_ball, -ball * n.y, s * axis.y + rho * out.y) + position.y, &places.y[i]);
    simd::store(select(at_ball, -ball * n.z, s * axis.z + rho * out.z) + position.z, &places.z[i]);
  }
}

}  // namespace hapbench
