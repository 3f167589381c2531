#include "tests/support/tool_kinds.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/tool/bur_profile.hpp"
#include "sim/tool/revolved.hpp"

namespace hapbench::test {
namespace {

using Real = long double;

/// Closed polygon of a profile and the axis, with the coordinates s along the axis and rho, the distance from the axis.
/// The even-odd rule determines which points are inside.
struct Section {
  std::vector<ProfilePoint> corners;  ///< from the axis at the shank's end to the axis at the tip
  Real ball;                          ///< radius of a round tip; 0 for a flat tip

  Section(std::vector<ProfilePoint> profile, Tip tip) : corners(std::move(profile)) {
    const ProfilePoint first = corners.front(), last = corners.back();
    ball = tip == Tip::round ? last.rho : 0.0;
    corners.insert(corners.begin(), {first.s, 0.0});
    corners.push_back({last.s, 0.0});
  }

  /// Returns true if the point is inside: a ray along +rho crosses an odd number of edges.
  bool contains(Real s, Real rho) const {
    if (ball > 0.0L && s > 0.0L) return std::hypot(s, rho) <= ball;
    bool in = false;
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const ProfilePoint a = corners[i], b = corners[i + 1];
      if ((a.s > s) == (b.s > s)) continue;
      in ^= a.rho + (b.rho - a.rho) * ((s - a.s) / (Real(b.s) - a.s)) > rho;
    }
    return in;
  }

  Real distance(Real s, Real rho) const {
    Real nearest = ball > 0.0L && s > 0.0L ? std::abs(std::hypot(s, rho) - ball) : 1e9L;
    // The last edge is the disc of a flat tip. A round tip has no disc, so skip the edge.
    for (std::size_t i = 0; i + (ball > 0.0L ? 2 : 1) < corners.size(); ++i) {
      const Real ds = Real(corners[i + 1].s) - corners[i].s, dr = Real(corners[i + 1].rho) - corners[i].rho;
      const Real from_s = s - corners[i].s, from_rho = rho - corners[i].rho, length2 = ds * ds + dr * dr;
      const Real fraction = length2 > 0.0L ? std::clamp((from_s * ds + from_rho * dr) / length2, 0.0L, 1.0L) : 0.0L;
      nearest = std::min(nearest, std::hypot(from_s - fraction * ds, from_rho - fraction * dr));
    }
    return nearest;
  }
};

Vec3 across(const ToolPose& pose, Random& random) {
  const Vec3 e1 = pose.axis.unitOrthogonal(), circle = random.direction_in_plane();
  return circle.x() * e1 + circle.y() * pose.axis.cross(e1);
}

/// Returns random points on the upper half of an ellipse with centre (0, 0) and semi-axes a and b, with
/// decreasing angles in [to, from]: a convex profile.
std::vector<ProfilePoint> on_ellipse(Random& random, double a, double b, double from, double to) {
  std::vector<double> angles(2 + random.below(8));
  for (double& angle : angles) angle = random.uniform(to, from);
  std::sort(angles.rbegin(), angles.rend());
  std::vector<ProfilePoint> points;
  for (const double angle : angles) points.push_back({a * std::cos(angle), b * std::sin(angle)});
  return points;
}

double thickness(Random& random, double unit) {
  return unit * random.uniform(0.1, 1.0);
}

DefinedTool convex(Random& random, double unit) {
  const double length = unit * random.uniform(0.2, 5.0);
  auto points = on_ellipse(random, length, thickness(random, unit), std::numbers::pi, 0.0);
  const double tip = points.back().s;
  for (ProfilePoint& p : points) p.s -= tip;
  if (random.below(2) == 0) points.insert(points.begin(), {points.front().s - 0.1 * length, 0.0});
  if (random.below(2) == 0) {  // pointed tip
    for (ProfilePoint& p : points) p.s -= 0.1 * length;
    points.push_back({0.0, 0.0});
  }
  // A solid with a pointed end is not always convex.
  return defined(std::move(points), Tip::flat);
}

DefinedTool round_convex(Random& random, double unit) {
  const double radius = thickness(random, unit);
  auto points =
      on_ellipse(random, unit * random.uniform(0.2, 5.0), radius, std::numbers::pi, 0.5 * std::numbers::pi + 1e-3);
  points.push_back({0.0, radius});
  return defined(std::move(points), Tip::round);
}

DefinedTool grooved(Random& random, double unit) {
  std::vector<ProfilePoint> points = {{0.0, thickness(random, unit)}};
  double s = 0.0;
  for (std::size_t n = 1 + random.below(6); n > 0; --n) {
    s -= unit * random.uniform(0.05, 1.0);
    points.insert(points.begin(), {s, thickness(random, unit)});
    if (n > 1 && random.below(2) == 0) points.insert(points.begin(), {s, thickness(random, unit)});
  }
  return defined(std::move(points), random.below(2) == 0 ? Tip::flat : Tip::round);
}

DefinedTool undercut(Random& random, double unit) {
  const double shank = thickness(random, unit), head = shank + thickness(random, unit);
  const double length = unit * random.uniform(0.5, 3.0);
  std::vector<ProfilePoint> points = {{-2.0 * length, shank},
                                      {-length, shank},
                                      {-length * random.uniform(1.1, 1.6), head},
                                      {0.0, shank + random.uniform(0.3, 1.0) * (head - shank)}};
  if (random.below(2) == 0) points.push_back({-0.5 * length, 0.5 * shank});  // hollow end with a disc
  if (random.below(2) == 0 && points.size() == 5) points.back().rho = 0.0;   // hollow end with a point
  return defined(std::move(points), Tip::flat);
}

DefinedTool mushroom(Random& random, double unit) {
  const double radius = thickness(random, unit), shank = radius * random.uniform(0.1, 0.9);
  return defined({{-unit * random.uniform(0.5, 5.0), shank}, {0.0, shank}, {0.0, radius}}, Tip::round);
}

DefinedTool bur(Random& random, double unit) {
  const auto family = static_cast<BurFamily>(random.below(7));
  const double diameter = thickness(random, unit);
  const double length = family == BurFamily::ball ? diameter : diameter * random.uniform(2.0, 5.0);
  BurProfile profile = bur_profile(family, diameter, length, diameter * random.uniform(0.2, 0.9));
  return defined(std::move(profile.profile), profile.tip);
}

Cylinder cylinder(Random& random, double unit, Tip tip) {
  // The length is at least the radius, because Revolved and Cylinder may differ for shorter tools with a round tip.
  const double radius = thickness(random, unit);
  return {radius, radius + unit * random.uniform(0.2, 10.0), tip};
}

const ToolKind kKinds[] = {
    {"flat_cylinder", true, [](Random& random, double unit) { return defined(cylinder(random, unit, Tip::flat)); }},
    {"round_cylinder", true, [](Random& random, double unit) { return defined(cylinder(random, unit, Tip::round)); }},
    {"convex", true, convex},
    {"round_convex", true, round_convex},
    {"grooved", true, grooved},
    {"undercut", false, undercut},
    {"mushroom", false, mushroom},
    {"bur", false, bur},
};

}  // namespace

ToolPose random_pose(Random& random) {
  return {random.uniform() * random.direction(), random.direction()};
}

std::span<const ToolKind> tool_kinds() {
  return kKinds;
}

DefinedTool defined(const Cylinder& tool) {
  DefinedTool cylinder = defined({{-tool.length(), tool.radius()}, {0.0, tool.radius()}}, tool.tip());
  cylinder.shape = std::make_shared<Cylinder>(tool);
  return cylinder;
}

DefinedTool defined(std::vector<ProfilePoint> profile, Tip tip) {
  const auto shape = std::make_shared<Revolved>(profile, tip);
  const auto section = std::make_shared<Section>(std::move(profile), tip);
  const double front = std::max(0.0, static_cast<double>(section->ball)), rear = shape->reach();
  return {shape,
          [section](const ToolPose& pose, const Vec3L& point) {
            const Vec3L x = point - pose.position.cast<Real>(), axis = pose.axis.cast<Real>();
            const Real s = x.dot(axis), rho = (x - s * axis).norm();
            const Real distance = section->distance(s, rho);
            return section->contains(s, rho) ? distance : -distance;
          },
          [shape, front, rear](const ToolPose& pose, Random& random) {
            const double r = 1.2 * shape->half_width() * std::sqrt(random.uniform());
            return Vec3(pose.position + random.uniform(-1.1 * rear, front + 0.1 * rear) * pose.axis +
                        r * across(pose, random));
          },
          [section](const ToolPose& pose, Random& random) {
            const std::vector<ProfilePoint>& c = section->corners;
            const std::size_t i = random.below(c.size() - 1);
            const double fraction = random.uniform(), ball = static_cast<double>(section->ball);
            double s = c[i].s + fraction * (c[i + 1].s - c[i].s), rho = c[i].rho + fraction * (c[i + 1].rho - c[i].rho);
            if (ball > 0.0 && i + 2 == c.size()) s = ball * fraction, rho = ball * std::sqrt(1.0 - fraction * fraction);
            return Vec3(pose.position + s * pose.axis + rho * across(pose, random));
          }};
}

}  // namespace hapbench::test
