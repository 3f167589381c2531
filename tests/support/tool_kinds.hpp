#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <span>

#include "sim/core/random.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/revolved.hpp"
#include "sim/tool/tool_shape.hpp"

/// The tool's body straight from its definition (see Cylinder), in long double: what searches and depth models are
/// checked against.
namespace hapbench::test {

using Vec3L = Eigen::Matrix<long double, 3, 1>;

/// How far the point lies inside the tool, along the tightest of its constraints [m]: >= 0 in the closed body, negative
/// outside. Concave in the point, because the body is convex.
long double slack(const Cylinder& tool, const ToolPose& pose, const Vec3L& point);

/// A point uniform in the bounding cylinder of the body, made 20 % larger on every side.
Vec3 random_point_near(const Cylinder& tool, const ToolPose& pose, Random& random);

/// A point on the tool's surface, to rounding.
Vec3 random_point_on(const Cylinder& tool, const ToolPose& pose, Random& random);

/// A pose anywhere within 1 m of the origin.
ToolPose random_pose(Random& random);

/// A tool of 0.1 to 1 mm radius and up to 10 mm length.
Cylinder random_tool(Random& random, Tip tip);

/// A tool shape made by the documentation of ToolShape alone, in plain loops: a brick with its tip centre in the middle
/// of one face. It is no solid of revolution, so it also tells whether a pose's roll arrives.
class Brick final : public ToolShape {
 public:
  /// Half extents across the axis and the length along it [m].
  Brick(double half_x, double half_y, double length);

  /// How far the point lies inside, by the nearest of the six faces [m]; negative outside.
  double slack(const ToolPose& pose, const Vec3& point) const;

  bool convex() const noexcept override { return true; }
  std::vector<ProfilePoint> outline() const override;
  void push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                   ContactBuffer& contacts) const noexcept override;
  void mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                   std::uint8_t* marks) const noexcept override;
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  double moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                       const PlaceArrays& places) const noexcept override;
  Grown grown(double margin) const override;

 private:
  Vec3 low_, high_;  ///< corners in the tool's frame, whose axis is -z
};

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
