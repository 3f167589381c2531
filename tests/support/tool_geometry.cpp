#include "tests/support/tool_geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hapbench::test {
namespace {

/// Two unit vectors that complete the axis to a frame.
struct Frame {
  Vec3 e1, e2;
  explicit Frame(const Vec3& axis) : e1(axis.unitOrthogonal()), e2(axis.cross(e1)) {}
};

}  // namespace

long double slack(const Cylinder& tool, const ToolPose& pose, const Vec3L& point) {
  const Vec3L x = point - pose.position.cast<long double>();
  const Vec3L axis = pose.axis.cast<long double>();
  const long double s = x.dot(axis);
  if (tool.tip() == Tip::round && s > 0.0L) return tool.radius() - x.norm();
  const long double side = tool.radius() - (x - s * axis).norm();
  const long double bottom = tool.length() + s;
  return tool.tip() == Tip::round ? std::min(side, bottom) : std::min({side, -s, bottom});
}

long double exit_along(const Cylinder& tool, const ToolPose& pose, const Vec3L& point, const Vec3L& direction) {
  long double inside = 0.0L, outside = 2.0L * (tool.length() + 4.0L * tool.radius());
  for (int i = 0; i < 100; ++i) {
    const long double middle = 0.5L * (inside + outside);
    (slack(tool, pose, point + middle * direction) >= 0.0L ? inside : outside) = middle;
  }
  return inside;
}

Vec3 random_point_near(const Cylinder& tool, const ToolPose& pose, Random& random) {
  const Frame frame(pose.axis);
  const Vec3 disc = random.direction_in_plane() * (1.2 * tool.radius() * std::sqrt(random.uniform()));
  const double s = random.uniform(-1.2 * tool.length(), tool.radius() + 0.2 * tool.length());
  return pose.position + s * pose.axis + disc.x() * frame.e1 + disc.y() * frame.e2;
}

Vec3 random_point_on(const Cylinder& tool, const ToolPose& pose, Random& random) {
  const Frame frame(pose.axis);
  const Vec3 circle = random.direction_in_plane();
  const Vec3 outwards = circle.x() * frame.e1 + circle.y() * frame.e2;
  switch (random.below(3)) {
    case 0:
      return pose.position - random.uniform(0.0, tool.length()) * pose.axis + tool.radius() * outwards;
    case 1:
      return pose.position - tool.length() * pose.axis + random.uniform(0.0, tool.radius()) * outwards;
    default:
      break;
  }
  if (tool.tip() == Tip::flat) return pose.position + random.uniform(0.0, tool.radius()) * outwards;
  const double s = random.uniform();
  return pose.position + tool.radius() * (s * pose.axis + std::sqrt(1.0 - s * s) * outwards);
}

ToolPose random_pose(Random& random) {
  return {random.uniform() * random.direction(), random.direction()};
}

Cylinder random_tool(Random& random, Tip tip) {
  return {random.uniform(1e-4, 1e-3), random.uniform(2e-4, 1e-2), tip};
}

}  // namespace hapbench::test
