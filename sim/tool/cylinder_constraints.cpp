#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/tool/axial.hpp"
#include "sim/tool/cylinder.hpp"

/// What a proxy asks of a cylinder, which is convex.
namespace hapbench {
namespace {

using simd::Mask, simd::Pack, simd::select;

/// Cosine to the axis below which a surface runs along the side, so that no edge comes first.
constexpr double kAlongSide = 1e-9;

struct Directions {
  Pack x, y, z;
};

/// Away from the axis, and in any one direction on it.
Directions away_from_axis(const AxialPack& q, const Pack& distance, const Pack& on_axis, const Vec3& any) {
  const Mask undefined = distance <= on_axis;
  const Pack scale = Pack(1.0) / select(undefined, Pack(1.0), distance);
  return {select(undefined, Pack(any.x()), q.rho_x * scale), select(undefined, Pack(any.y()), q.rho_y * scale),
          select(undefined, Pack(any.z()), q.rho_z * scale)};
}

}  // namespace

void Cylinder::surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                                   ContactBuffer& contacts) const noexcept {
  const bool round = tip_ == Tip::round;
  const Pack radius(radius_), length(length_), zero(0.0), one(1.0);
  const Pack ax(pose.axis.x()), ay(pose.axis.y()), az(pose.axis.z());
  const Pack wx(wanted.x()), wy(wanted.y()), wz(wanted.z()), in_reach(-slack), flush(kFlush);
  const Vec3 any = pose.axis.unitOrthogonal();
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack from_axis = simd::sqrt(q.rho2);
    const Directions out = away_from_axis(q, from_axis, Pack(kOnAxis) * radius, any);
    const Pack side = from_axis - radius;
    const Pack bottom = -q.s - length;
    const Mask tip_nearer = q.s >= bottom;
    const Pack end = round ? bottom : simd::max(q.s, bottom);
    const Pack forward = round ? -one : select(tip_nearer, one, -one);

    const Mask side_wins = side >= end;
    Pack distance = select(side_wins, side, end);
    Pack outwards = select(side_wins, one, zero);
    Pack along = forward * select(side_wins, zero, one);
    if (const Mask at_edge = side > in_reach && end > in_reach; simd::any(at_edge)) {
      // Beyond side and end the nearest place is the edge between them.
      const Mask beyond_both = side > zero && end > zero;
      const Pack to_edge = simd::sqrt(side * side + end * end);
      const Pack edge_scale = one / select(beyond_both, to_edge, one);
      distance = select(beyond_both, to_edge, distance);
      outwards = select(beyond_both, side * edge_scale, outwards);
      along = select(beyond_both, forward * (end * edge_scale), along);

      const Pack towards_side = out.x * wx + out.y * wy + out.z * wz;
      const Pack towards_end = ax * wx + ay * wy + az * wz;
      const Pack nx = simd::load(&contacts.nx[i]), ny = simd::load(&contacts.ny[i]), nz = simd::load(&contacts.nz[i]);
      const Pack faces_side = -(out.x * nx + out.y * ny + out.z * nz),
                 faces_end = -forward * (ax * nx + ay * ny + az * nz);
      const Mask bumps = at_edge && outwards * towards_side + along * towards_end > distance;
      const Mask along_end = bumps && faces_end > flush, along_side = bumps && faces_side > flush;
      distance = select(along_end, end, select(along_side, side, distance));
      outwards = select(along_end, zero, select(along_side, one, outwards));
      along = select(along_end, forward, select(along_side, zero, along));
    }
    Pack mx = outwards * out.x + along * ax, my = outwards * out.y + along * ay, mz = outwards * out.z + along * az;
    if (round) {
      const Pack from_centre = simd::sqrt(q.distance2());
      // In a tool shorter than its radius the bottom may be nearer than the ball.
      const Mask at_ball = q.s > zero && from_centre - radius >= bottom;
      const Pack scale = one / select(at_ball, from_centre, one);
      distance = select(at_ball, from_centre - radius, distance);
      mx = select(at_ball, q.x * scale, mx);
      my = select(at_ball, q.y * scale, my);
      mz = select(at_ball, q.z * scale, mz);
    }
    simd::store(-distance, &contacts.depth[i]);
    simd::store(mx, &contacts.ux[i]);
    simd::store(my, &contacts.uy[i]);
    simd::store(mz, &contacts.uz[i]);
  }
  contacts.pad();
}

void Cylinder::foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                               const PlaceArrays& places) const noexcept {
  const Pack radius(radius_), length(length_), zero(0.0), one(1.0), along_side(kAlongSide);
  // forward is at most 1: a flat tip has no ball.
  const Pack ball_from(tip_ == Tip::round ? kAlongSide : 2.0);
  const Pack px(pose.position.x()), py(pose.position.y()), pz(pose.position.z());
  const Pack ax(pose.axis.x()), ay(pose.axis.y()), az(pose.axis.z());
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack nx = simd::load(&contacts.nx[i]), ny = simd::load(&contacts.ny[i]), nz = simd::load(&contacts.nz[i]);
    const Pack forward = -(nx * ax + ny * ay + nz * az);
    const Pack x = -nx - forward * ax, y = -ny - forward * ay, z = -nz - forward * az;
    const Pack outwards = simd::sqrt(x * x + y * y + z * z);
    const Mask on_axis = outwards <= zero;
    const Pack scale = select(on_axis, zero, radius / select(on_axis, one, outwards));
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack abreast = simd::max(-length, simd::min(q.s, zero));
    Pack s = select(forward > zero, zero, -length);
    s = select(simd::abs(forward) < along_side, abreast, s);
    const Mask at_ball = forward > ball_from;
    simd::store(px + select(at_ball, -radius * nx, s * ax + scale * x), &places.x[i]);
    simd::store(py + select(at_ball, -radius * ny, s * ay + scale * y), &places.y[i]);
    simd::store(pz + select(at_ball, -radius * nz, s * az + scale * z), &places.z[i]);
  }
}

}  // namespace hapbench
