#include "algorithms/depth/normal_projection_depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapbench {

const ModelInfo kNormalProjectionDepthInfo = {
    .name = "normal_projection",
    .summary = "distance along the inverse surface normal to where it leaves the tool",
    .formula =
        "u = -n, d = smallest exit of the ray x + d u through side (F.7), tip (F.9) and bottom (F.12); "
        "a round tip replaces the tip plane by the half ball",
    .source = "thesis F.1 (F.6 printed with a minus; F.7 shows that r_p + d r_n is meant)",
    .known_failure = "a point that appears at a corner can start with a large depth: the force jumps (Fig. F.4)",
};

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

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
double exit_side(const Tool& tool, const Vec3& rho, const Vec3& radial_u) {
  const double a = radial_u.squaredNorm();
  const double c = std::max(0.0, tool.radius * tool.radius - rho.squaredNorm());
  return a == 0.0 ? kNever : if_positive(exit_root(a, rho.dot(radial_u), c));
}

/// Exit through the half ball beyond the tip plane; never when the ray misses the ball or leaves it behind the plane.
double exit_half_ball(const Tool& tool, const Vec3& x, const Vec3& u, double s, double slope) {
  const double b = x.dot(u);
  const double c = tool.radius * tool.radius - x.squaredNorm();
  const double discriminant = b * b + c;
  if (discriminant < 0.0) return kNever;
  const double d = c >= 0.0 ? exit_root(1.0, b, c) : std::sqrt(discriminant) - b;
  return s + d * slope >= 0.0 ? if_positive(d) : kNever;
}

}  // namespace

double exit_distance(const Tool& tool, const ToolPose& pose, const Vec3& point, const Vec3& u) noexcept {
  const Vec3 x = point - pose.position;
  const double s = x.dot(pose.axis);
  const double slope = u.dot(pose.axis);
  double d = exit_side(tool, x - s * pose.axis, u - slope * pose.axis);
  // A ray leaves through the tip only forwards and through the bottom only backwards. For points inside that is what
  // "positive" means; for a point on such a surface, s is known to rounding only and its sign proves nothing.
  if (tool.tip == Tip::round) {
    d = std::min(d, exit_half_ball(tool, x, u, s, slope));
  } else if (slope > 0.0) {
    d = std::min(d, if_positive(-s / slope));
  }
  if (slope < 0.0) d = std::min(d, if_positive(-(tool.length + s) / slope));
  // Only a surface that goes on beyond the body is met further away than the longest way through it, which is shorter
  // than this: the point lies on another surface, almost along which the ray points. Such depths have no bound.
  return d > tool.length + 3.0 * tool.radius ? 0.0 : d;
}

namespace {

class NormalProjectionDepth final : public DepthModel {
 public:
  void evaluate(const Tool& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Vec3 u = -contacts.normal(i);
      contacts.set_gradient(i, u);
      contacts.depth[i] = exit_distance(tool, pose, contacts.point(i), u);
    }
    contacts.pad();
  }
};

}  // namespace

std::unique_ptr<DepthModel> make_normal_projection_depth() {
  return std::make_unique<NormalProjectionDepth>();
}

}  // namespace hapbench
