#include "sim/tool/cylinder.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "sim/core/math.hpp"
#include "sim/tool/axial.hpp"

namespace hapbench {
namespace {

using simd::Mask, simd::Pack, simd::select;

/// Largest |cosine| of the angle between a contact's normal and the axis at which the side counts as parallel to the
/// surface. All points of a line along the side are then support points.
constexpr double kAlongSide = 1e-9;

Vec3 shortest_gradient(const Cylinder& tool, const ToolPose& pose, const ContactBuffer& contacts, std::size_t i) {
  // The operations and their order are the same as in AxialPack, so that depth and gradient choose the same
  // surface.
  const Vec3 x = contacts.point(i) - pose.position;
  const double s = x.x() * pose.axis.x() + x.y() * pose.axis.y() + x.z() * pose.axis.z();
  // In the half ball of a round tip the radial direction starts at the tip centre.
  const bool in_ball = tool.tip() == Tip::round && s > 0.0;
  const Vec3 radial = in_ball ? x : Vec3(x - s * pose.axis);
  const double length = std::sqrt(radial.x() * radial.x() + radial.y() * radial.y() + radial.z() * radial.z());
  const double d_radial = tool.radius() - length;
  // Choose the closest of side, tip and bottom.
  if (!in_ball) {
    const double d_tip = tool.tip() == Tip::flat ? -s : d_radial;
    const double d_bottom = tool.length() + s;
    if (d_tip < d_radial && d_tip <= d_bottom) return pose.axis;
    if (d_bottom < d_radial && d_bottom < d_tip) return -pose.axis;
  }
  return length < kOnAxis * tool.radius() ? Vec3(-contacts.normal(i)) : Vec3(radial / length);
}

/// Returns d if it is positive, and kNever otherwise. The thesis uses "the minimal positive value". If a point lies
/// exactly on a surface and its ray points outwards, the exit is therefore on another surface, or the depth is 0 if
/// no other surface is in reach.
double if_positive(double d) {
  return d > 0.0 ? d : kNever;
}

/// Returns the larger root d >= 0 of a d^2 + 2 b d - c = 0, without cancellation for b > 0. Precondition: a > 0, c
/// >= 0.
double exit_root(double a, double b, double c) {
  const double root = std::sqrt(b * b + a * c);
  return b > 0.0 ? c / (b + root) : (root - b) / a;
}

/// Returns the exit distance through the side (thesis Eq. F.7); kNever if the ray is parallel to the axis.
double exit_side(double radius, const Vec3& rho, const Vec3& radial_u) {
  const double a = radial_u.squaredNorm();
  const double c = std::max(0.0, radius * radius - rho.squaredNorm());
  return a == 0.0 ? kNever : if_positive(exit_root(a, rho.dot(radial_u), c));
}

/// Returns the exit distance through the half ball beyond the tip plane; kNever if the ray misses the ball or
/// leaves the ball behind the tip plane, on the bottom's side.
double exit_half_ball(double radius, const Vec3& x, const Vec3& u, double s, double slope) {
  const double b = x.dot(u);
  const double c = radius * radius - x.squaredNorm();
  const double discriminant = b * b + c;
  if (discriminant < 0.0) return kNever;
  const double d = c >= 0.0 ? exit_root(1.0, b, c) : std::sqrt(discriminant) - b;
  return s + d * slope >= 0.0 ? if_positive(d) : kNever;
}

/// Returns the distance at which the ray from `point` along u first leaves the body: through the side (thesis Eq. F.7),
/// the tip (Eq. F.9) or the bottom (Eq. F.12).
double exit_distance(const Cylinder& tool, const ToolPose& pose, const Vec3& point, const Vec3& u) {
  const Vec3 x = point - pose.position;
  const double s = x.dot(pose.axis);
  const double slope = u.dot(pose.axis);
  double d = exit_side(tool.radius(), x - s * pose.axis, u - slope * pose.axis);
  // A ray leaves through the tip only if it runs forwards (slope > 0), and through the bottom only if it runs
  // backwards. For a point inside, a positive distance implies this direction. For a point on the tip or on the bottom,
  // the sign of the distance is only rounding, so the direction is tested as well.
  if (tool.tip() == Tip::round) {
    d = std::min(d, exit_half_ball(tool.radius(), x, u, s, slope));
  } else if (slope > 0.0) {
    d = std::min(d, if_positive(-s / slope));
  }
  if (slope < 0.0) d = std::min(d, if_positive(-(tool.length() + s) / slope));
  // No exit from the body is farther away than its longest chord. A larger value is an intersection with the infinite
  // extension of a surface beyond the body, such as the side of an infinitely long cylinder. This happens if the point
  // lies on another surface and its ray is almost parallel to the extended surface. The depth is then set to 0, because
  // it would otherwise be unbounded.
  return d > tool.max_exit_distance() ? 0.0 : d;
}

}  // namespace

double largest_square_within(double r) {
  constexpr double up = std::numeric_limits<double>::infinity();
  double square = r * r;
  while (std::sqrt(square) > r) square = std::nextafter(square, 0.0);
  while (std::sqrt(std::nextafter(square, up)) <= r) square = std::nextafter(square, up);
  return square;
}

Cylinder::Cylinder(double radius, double length, Tip tip)
    : ToolShape(radius, math::hypot(length, radius)),
      radius_(radius),
      length_(length),
      tip_(tip),
      radius2_(largest_square_within(radius)) {}

std::vector<ProfilePoint> Cylinder::outline() const {
  return closed_outline({{-length_, radius_}, {0.0, radius_}}, tip_);
}

void Cylinder::push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                           ContactBuffer& contacts) const noexcept {
  const Pack bottom(-length_), radius2(radius2_), zero(0.0);
  const auto in_cylinder = [=](const AxialPack& q) { return q.s <= zero && q.s >= bottom && q.rho2 <= radius2; };
  if (tip_ == Tip::flat) return push(pose, points, packs, contacts, in_cylinder);
  push(pose, points, packs, contacts,
       [=](const AxialPack& q) { return in_cylinder(q) || (q.s > zero && q.distance2() <= radius2); });
}

void Cylinder::mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept {
  const double radius = radius_ + margin;
  const Pack radius2(radius * radius), low(-length_ - margin), high(tip_ == Tip::round ? radius : margin);
  mark(pose, points, ranges, marks, [&](const AxialPack& q) { return q.s <= high && q.s >= low && q.rho2 <= radius2; });
}

Box Cylinder::box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept {
  const double radius = radius_ + margin;
  const AxisInterval whole{-(length_ + margin), tip_ == Tip::round ? radius : margin};
  const AxisInterval part = axis_interval_near(whole, pose, radius, bounds);
  return box_around(part, pose, radius);
}

ToolShape::Cover Cylinder::cover(double margin) const {
  const double radius = radius_ + margin;
  return row_of_balls(radius, length_ + margin + (tip_ == Tip::round ? radius : margin));
}

ToolShape::Grown Cylinder::grown(double margin) const {
  const bool flat = tip_ == Tip::flat;  // a round tip grows with the radius
  const double ends = flat ? 2.0 * margin : margin;
  return {std::make_unique<Cylinder>(radius_ + margin, length_ + ends, tip_), flat ? margin : 0.0};
}

void Cylinder::shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  const Pack radius(radius_), length(length_), zero(0.0);
  const bool round = tip_ == Tip::round;
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack side = radius - simd::sqrt(q.rho2);
    const Pack bottom = length + q.s;
    Pack d = simd::min(side, bottom);
    d = round ? select(q.s > zero, radius - simd::sqrt(q.distance2()), d) : simd::min(d, -q.s);
    simd::store(d, &contacts.depth[i]);
  }
}

void Cylinder::shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts.set_gradient(i, shortest_gradient(*this, pose, contacts, i));
  }
}

void Cylinder::exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    exits[i] = exit_distance(*this, pose, contacts.point(i), contacts.gradient(i));
  }
}

void Cylinder::surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                                   ContactBuffer& contacts) const noexcept {
  const bool round = tip_ == Tip::round;
  const Pack radius(radius_), length(length_), zero(0.0), one(1.0);
  const Pack on_axis(kOnAxis * radius_), in_reach(-slack), flush(kFlush);
  const PackVector axis(pose.axis), any(pose.axis.unitOrthogonal()), move(wanted);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    // Axial coordinates of the contacts, and the unit vector away from the axis.
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack from_axis = simd::sqrt(q.rho2);
    // On the axis any direction perpendicular to it is valid.
    const PackVector out = unit_or(!(from_axis <= on_axis), {q.rho_x, q.rho_y, q.rho_z}, from_axis, any);
    // Signed distances to the side and to the closer end.
    const Pack side = from_axis - radius;
    const Pack bottom = -q.s - length;
    const Mask tip_nearer = q.s >= bottom;
    const Pack end = round ? bottom : simd::max(q.s, bottom);
    const Pack forward = round ? -one : select(tip_nearer, one, -one);

    // Choose the closest face: the largest signed distance.
    const Mask side_wins = side >= end;
    Pack distance = select(side_wins, side, end);
    Pack outwards = select(side_wins, one, zero);
    Pack along = forward * select(side_wins, zero, one);
    if (const Mask at_edge = side > in_reach && end > in_reach; simd::any(at_edge)) {
      // Beyond both side and end, the closest point is on the edge between them.
      const Mask beyond_both = side > zero && end > zero;
      const Pack to_edge = simd::sqrt(side * side + end * end);
      const Pack edge_scale = one / select(beyond_both, to_edge, one);
      distance = select(beyond_both, to_edge, distance);
      outwards = select(beyond_both, side * edge_scale, outwards);
      along = select(beyond_both, forward * (end * edge_scale), along);

      // If the displacement `wanted` violates the constraint at an edge, use instead the constraint of a face that is
      // flush with the surface.
      const PackVector n(&contacts.nx[i], &contacts.ny[i], &contacts.nz[i]);
      const Pack faces_side = -out.dot(n), faces_end = -forward * axis.dot(n);
      const Mask bumps = at_edge && outwards * out.dot(move) + along * axis.dot(move) > distance;
      const Mask along_end = bumps && faces_end > flush, along_side = bumps && faces_side > flush;
      distance = select(along_end, end, select(along_side, side, distance));
      outwards = select(along_end, zero, select(along_side, one, outwards));
      along = select(along_end, forward, select(along_side, zero, along));
    }
    PackVector normal = combined(outwards, out, along, axis);
    if (round) {
      const Pack from_centre = simd::sqrt(q.distance2());
      // If the tool is shorter than its radius, the bottom may be closer than the ball.
      const Mask at_ball = q.s > zero && from_centre - radius >= bottom;
      distance = select(at_ball, from_centre - radius, distance);
      normal = unit_or(at_ball, {q.x, q.y, q.z}, from_centre, normal);
    }
    simd::store(-distance, &contacts.depth[i]);
    normal.store(&contacts.ux[i], &contacts.uy[i], &contacts.uz[i]);
  }
  contacts.pad();
}

void Cylinder::support_points(const ToolPose& pose, const ContactBuffer& contacts,
                              const MutablePointArrays& surface_points) const noexcept {
  const Pack radius(radius_), length(length_), zero(0.0), one(1.0), along_side(kAlongSide);
  // For a flat tip the condition forward > 2 is never true.
  const Pack ball_from(tip_ == Tip::round ? kAlongSide : 2.0);
  const Pack px(pose.position.x()), py(pose.position.y()), pz(pose.position.z());
  const Pack ax(pose.axis.x()), ay(pose.axis.y()), az(pose.axis.z());
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack nx = simd::load(&contacts.nx[i]), ny = simd::load(&contacts.ny[i]), nz = simd::load(&contacts.nz[i]);
    // Components of -n along the axis and perpendicular to it.
    const Pack forward = -(nx * ax + ny * ay + nz * az);
    const Pack x = -nx - forward * ax, y = -ny - forward * ay, z = -nz - forward * az;
    const Pack outwards = simd::sqrt(x * x + y * y + z * z);
    const Mask on_axis = outwards <= zero;
    const Pack scale = select(on_axis, zero, radius / select(on_axis, one, outwards));
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    // A side parallel to the surface touches it along a line: use the point of this line closest to the contact.
    const Pack beside = simd::max(-length, simd::min(q.s, zero));
    Pack s = select(forward > zero, zero, -length);
    s = select(simd::abs(forward) < along_side, beside, s);
    const Mask at_ball = forward > ball_from;
    simd::store(px + select(at_ball, -radius * nx, s * ax + scale * x), &surface_points.x[i]);
    simd::store(py + select(at_ball, -radius * ny, s * ay + scale * y), &surface_points.y[i]);
    simd::store(pz + select(at_ball, -radius * nz, s * az + scale * z), &surface_points.z[i]);
  }
}

}  // namespace hapbench
