#pragma once

#include "sim/core/random.hpp"
#include "sim/tool/cylinder.hpp"

/// The tool's body straight from its definition (see Cylinder), in long double: what searches and depth models are
/// checked against.
namespace hapbench::test {

using Vec3L = Eigen::Matrix<long double, 3, 1>;

/// How far the point lies inside the tool, along the tightest of its constraints [m]: >= 0 in the closed body, negative
/// outside. Concave in the point, because the body is convex.
long double slack(const Cylinder& tool, const ToolPose& pose, const Vec3L& point);

/// The largest d with point + d * direction in the tool, by bisection; `point` lies in the tool.
long double exit_along(const Cylinder& tool, const ToolPose& pose, const Vec3L& point, const Vec3L& direction);

/// A point uniform in the bounding cylinder of the body, made 20 % larger on every side.
Vec3 random_point_near(const Cylinder& tool, const ToolPose& pose, Random& random);

/// A point on the tool's surface, to rounding.
Vec3 random_point_on(const Cylinder& tool, const ToolPose& pose, Random& random);

/// A pose anywhere within 1 m of the origin.
ToolPose random_pose(Random& random);

/// A tool of 0.1 to 1 mm radius and up to 10 mm length.
Cylinder random_tool(Random& random, Tip tip);

}  // namespace hapbench::test
