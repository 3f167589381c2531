#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <span>

#include "sim/core/random.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/revolved.hpp"
#include "sim/tool/tool_shape.hpp"

/// The body of each kind of tool straight from its definition, in long double: what searches and depth models are
/// checked against.
namespace hapbench::test {

using Vec3L = Eigen::Matrix<long double, 3, 1>;

/// A pose anywhere within 1 m of the origin.
ToolPose random_pose(Random& random);

struct DefinedTool {
  std::shared_ptr<const ToolShape> shape;
  /// In long double: in the closed body the distance to the surface, negative outside.
  std::function<long double(const ToolPose&, const Vec3L&)> slack;
  /// A point around the body: inside, outside and anywhere near.
  std::function<Vec3(const ToolPose&, Random&)> near_point;
  /// A point on the surface, to rounding.
  std::function<Vec3(const ToolPose&, Random&)> surface_point;
};

struct ToolKind {
  const char* name;
  bool some_convex;  ///< are some of the kind convex?
  /// A random tool of the kind, 0.1 to 1 `unit` thick. All of its lengths are proportional to the unit.
  DefinedTool (*make)(Random& random, double unit);

  friend void PrintTo(const ToolKind& kind, std::ostream* out) { *out << kind.name; }
};

/// Cylinders of both tips; and solids of revolution: convex ones of both tips, ones with grooves, undercut and hollow
/// ones, half balls on thinner shanks, burs.
std::span<const ToolKind> tool_kinds();

DefinedTool defined(const Cylinder& tool);
DefinedTool defined(std::vector<ProfilePoint> profile, Tip tip);

}  // namespace hapbench::test
