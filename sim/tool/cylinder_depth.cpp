#include <algorithm>
#include <cmath>

#include "sim/tool/axial.hpp"
#include "sim/tool/cylinder.hpp"

/// What depth models ask of a cylinder.
namespace hapbench {
namespace {

Vec3 shortest_gradient(const Cylinder& tool, const ToolPose& pose, const ContactBuffer& contacts, std::size_t i) {
  // The same order of operations as AxialPack, so that "which surface is nearest" is decided on the same numbers.
  const Vec3 x = contacts.point(i) - pose.position;
  const double s = x.x() * pose.axis.x() + x.y() * pose.axis.y() + x.z() * pose.axis.z();
  const bool in_ball = tool.tip() == Tip::round && s > 0.0;
  const Vec3 radial = in_ball ? x : Vec3(x - s * pose.axis);
  const double length = std::sqrt(radial.x() * radial.x() + radial.y() * radial.y() + radial.z() * radial.z());
  const double d_radial = tool.radius() - length;
  if (!in_ball) {
    const double d_tip = tool.tip() == Tip::flat ? -s : d_radial;
    const double d_bottom = tool.length() + s;
    if (d_tip < d_radial && d_tip <= d_bottom) return pose.axis;
    if (d_bottom < d_radial && d_bottom < d_tip) return -pose.axis;
  }
  return length < kOnAxis * tool.radius() ? Vec3(-contacts.normal(i)) : Vec3(radial / length);
}

/// Only positive exits count, as the thesis says ("the minimal positive value"): a point exactly on one surface whose
/// ray points outwards there takes the next surface, or depth 0 when there is none within reach.
double if_positive(double d) {
  return d > 0.0 ? d : kNever;
}

/// The larger root d >= 0 of a d^2 + 2 b d - c = 0 with a > 0, c >= 0, without cancellation for b > 0.
double exit_root(double a, double b, double c) {
  const double root = std::sqrt(b * b + a * c);
  return b > 0.0 ? c / (b + root) : (root - b) / a;
}

/// Exit through the side wall, F.7; never when the ray runs along the axis.
double exit_side(double radius, const Vec3& rho, const Vec3& radial_u) {
  const double a = radial_u.squaredNorm();
  const double c = std::max(0.0, radius * radius - rho.squaredNorm());
  return a == 0.0 ? kNever : if_positive(exit_root(a, rho.dot(radial_u), c));
}

/// Exit through the half ball beyond the tip plane; never when the ray misses the ball or leaves it behind the plane.
double exit_half_ball(double radius, const Vec3& x, const Vec3& u, double s, double slope) {
  const double b = x.dot(u);
  const double c = radius * radius - x.squaredNorm();
  const double discriminant = b * b + c;
  if (discriminant < 0.0) return kNever;
  const double d = c >= 0.0 ? exit_root(1.0, b, c) : std::sqrt(discriminant) - b;
  return s + d * slope >= 0.0 ? if_positive(d) : kNever;
}

/// Where the ray from `point` along u leaves the body first: through the side (thesis F.7), the tip (F.9) or the bottom
/// (F.12).
double exit_distance(const Cylinder& tool, const ToolPose& pose, const Vec3& point, const Vec3& u) {
  const Vec3 x = point - pose.position;
  const double s = x.dot(pose.axis);
  const double slope = u.dot(pose.axis);
  double d = exit_side(tool.radius(), x - s * pose.axis, u - slope * pose.axis);
  // A ray leaves through the tip only forwards and through the bottom only backwards. For points inside that is what
  // "positive" means; for a point on such a surface, s is known to rounding only and its sign proves nothing.
  if (tool.tip() == Tip::round) {
    d = std::min(d, exit_half_ball(tool.radius(), x, u, s, slope));
  } else if (slope > 0.0) {
    d = std::min(d, if_positive(-s / slope));
  }
  if (slope < 0.0) d = std::min(d, if_positive(-(tool.length() + s) / slope));
  // Only a surface that goes on beyond the body is met further away than the longest way through it: the point lies on
  // another surface, almost along which the ray points. Such depths have no bound.
  return d > tool.longest_exit() ? 0.0 : d;
}

}  // namespace

void Cylinder::shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  using simd::Pack;
  const Pack radius(radius_), length(length_), zero(0.0);
  const bool round = tip_ == Tip::round;
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const AxialPack q(pose, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const Pack side = radius - simd::sqrt(q.rho2);
    const Pack bottom = length + q.s;
    Pack d = simd::min(side, bottom);
    d = round ? simd::select(q.s > zero, radius - simd::sqrt(q.distance2()), d) : simd::min(d, -q.s);
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

}  // namespace hapbench
