#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <span>

#include "sim/core/random.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/revolved.hpp"
#include "sim/tool/tool_shape.hpp"

/// The body of each kind of tool, computed directly from its definition in long double. A reference for contact
/// searches and depth models.
namespace hapbench::test {

using Vec3L = Eigen::Matrix<long double, 3, 1>;

/// Returns a random pose within 1 m of the origin.
ToolPose random_pose(Random& random);

/// A tool and its definition.
struct DefinedTool {
  std::shared_ptr<const ToolShape> shape;
  /// Distance of a point from the body's surface [m], computed in long double; negative outside the body.
  std::function<long double(const ToolPose&, const Vec3L&)> slack;
  /// Returns a random point inside or near the body.
  std::function<Vec3(const ToolPose&, Random&)> near_point;
  /// Returns a random point on the surface, up to rounding.
  std::function<Vec3(const ToolPose&, Random&)> surface_point;
};

/// A kind of tool that random tools are drawn from.
struct ToolKind {
  const char* name;
  bool some_convex;  ///< true if some tools of the kind are convex
  /// Returns a random tool of the kind, with a thickness of 0.1 to 1 `unit`. All lengths are proportional to
  /// `unit`.
  DefinedTool (*make)(Random& random, double unit);

  friend void PrintTo(const ToolKind& kind, std::ostream* out) { *out << kind.name; }
};

/// Returns the kinds: cylinders with flat and round tips, and solids of revolution (convex with flat and round
/// tips, grooved, undercut and hollow solids, hemispheres on thinner shanks, burs).
std::span<const ToolKind> tool_kinds();

/// Returns the tool with its definition.
DefinedTool defined(const Cylinder& tool);
DefinedTool defined(std::vector<ProfilePoint> profile, Tip tip);

}  // namespace hapbench::test
