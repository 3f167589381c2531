#include "results/observe/interpenetration.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace hapbench {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr int kSamples = 64;
constexpr double kAngleTolerance = 1e-8;

/// Largest value of f in [low, high] by golden section, if it has one hill there.
template <class Function>
double top_of_hill(const Function& f, double low, double high) {
  constexpr double kGolden = std::numbers::phi - 1.0;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double f_a = f(a), f_b = f(b);
  while (high - low > kAngleTolerance) {
    if (f_a > f_b) {
      high = b;
      b = a;
      f_b = f_a;
      a = high - kGolden * (high - low);
      f_a = f(a);
    } else {
      low = a;
      a = b;
      f_a = f_b;
      b = low + kGolden * (high - low);
      f_b = f(b);
    }
  }
  return std::max(f_a, f_b);
}

/// Largest value of f over the circle, and at least 0: every hill of the samples is climbed that may be the highest, as
/// f changes by at most `slope` per radian.
template <class Function>
double largest_on_circle(const Function& f, double slope) {
  std::array<double, kSamples> value{};
  const double step = kTwoPi / kSamples;
  for (int i = 0; i < kSamples; ++i) value[static_cast<std::size_t>(i)] = f(i * step);
  const auto at = [&value](int i) { return value[static_cast<std::size_t>((i + kSamples) % kSamples)]; };
  double largest = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const bool hill = at(i) >= at(i - 1) && at(i) >= at(i + 1);
    if (hill && at(i) + slope * step > largest)
      largest = std::max(largest, top_of_hill(f, (i - 1) * step, (i + 1) * step));
  }
  return largest;
}

/// The largest t >= 0 with start + t * along in the tool. When there is none, minus the distance by which the line
/// misses the cylinder, so that the search finds narrow hits between its samples.
double last_in_tool(const Cylinder& tool, const ToolPose& pose, const Vec3& start, const Vec3& along) {
  const Vec3 x = start - pose.position;
  const double s = x.dot(pose.axis), ds = along.dot(pose.axis);
  const Vec3 rho = x - s * pose.axis, drho = along - ds * pose.axis;
  double low = 0.0, high = std::numeric_limits<double>::infinity();

  // In the cylinder: |rho + t drho|^2 <= r^2.
  const double a = drho.squaredNorm(), b = rho.dot(drho);
  const double middle = a > 0.0 ? -b / a : 0.0;
  const double miss2 = (rho + middle * drho).squaredNorm(), r2 = tool.radius() * tool.radius();
  if (miss2 > r2) return tool.radius() - std::sqrt(miss2);
  if (a > 0.0) {
    const double half = std::sqrt((r2 - miss2) / a);
    low = std::max(low, middle - half);
    high = middle + half;
  }
  // Between the planes: -length <= s + t ds <= 0.
  if (ds != 0.0) {
    const double t_tip = -s / ds, t_bottom = (-tool.length() - s) / ds;
    low = std::max(low, std::min(t_tip, t_bottom));
    high = std::min(high, std::max(t_tip, t_bottom));
  } else if (s > 0.0 || s < -tool.length()) {
    return -tool.length();
  }
  return low <= high ? high : -tool.length();
}

}  // namespace

double interpenetration(const BlockWithHole& block, const Cylinder& tool, const ToolPose& pose) {
  const double sine = std::hypot(pose.axis.x(), pose.axis.y());
  if (pose.position.z() - tool.radius() * sine >= 0.0) return 0.0;  // all above the top face
  const Vec3 e1 = pose.axis.unitOrthogonal(), e2 = pose.axis.cross(e1);
  const double on_edge = largest_on_circle(
      [&](double angle) {
        const Vec3 edge = pose.position + tool.radius() * (std::cos(angle) * e1 + std::sin(angle) * e2);
        return -signed_distance(block, edge);
      },
      tool.radius());
  const double R = block.hole_diameter / 2;
  const double on_cone = largest_on_circle(
      [&](double angle) {
        const Vec3 out{std::cos(angle), std::sin(angle), 0.0};
        return last_in_tool(tool, pose, R * out, out - Vec3::UnitZ());
      },
      std::numeric_limits<double>::infinity());
  return std::max(on_edge, on_cone);
}

}  // namespace hapbench
