#pragma once

#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/triangle_tree.hpp"

/// Frictionless contact of a tool with rigid triangles: a reference for force laws.
namespace hapbench {

/// Model of a cylinder with a round tip: all points within `radius` [m] of the segment from the tip centre to the point
/// `length` [m] behind it. The far end of the model is round, whereas the far end of the tool is flat.
struct RoundTool {
  double radius, length;
};

/// Computes the free position of a tool that is nearest to a prescribed position x. At a free position, the tool
/// overlaps no triangle. A frictionless spring with the stiffness K pulls a tool between rigid triangles towards x. The
/// tool rests at this free position x', and the force on it is K (x' - x).
///
/// Method: a triangle T is touched if the distance of the tool's segment from T is the tool's radius. This distance is
/// a convex function of the tool's position. Hence, where the linearised distance is at least the radius, the tool does
/// not overlap T. These positions form a half-space, and straight paths within the half-space are free of T as well.
/// The search moves from the last free position to the point nearest to x in the half-spaces of all near triangles, and
/// repeats this until the position no longer changes. The search cannot pass a triangle. It ends at a local minimum of
/// |x' - x| in the free space that the path has reached.
class RigidContact {
 public:
  RigidContact(TriangleSoup surface, const RoundTool& tool);

  /// Sets the free position from which the next search starts. `axis`: unit vector out of the tip. Returns false if the
  /// tool touches a triangle there.
  bool start(const Vec3& position, const Vec3& axis);
  /// Returns the free position nearest to `position` that is reached from the last free position [m].
  Vec3 follow(const Vec3& position, const Vec3& axis);

  /// Largest error of all free positions so far [m], estimated from the last two moves of each search.
  double error() const noexcept { return error_; }
  /// Returns true if the far end of the segment was the point nearest to a touched triangle. The results do not hold
  /// then, because the tool's far end is flat.
  bool touched_far_end() const noexcept { return touched_far_end_; }

 private:
  /// A triangle with a ball around it.
  struct Triangle {
    Vec3 a, b, c, centre;
    double radius;
  };
  /// Distance between the tool's segment and a triangle [m], and the gradient of this distance with respect to the
  /// tool's position. `at_far_end`: true if the far end of the segment is its point nearest to the triangle.
  struct Gap {
    double distance;
    Vec3 normal;
    bool at_far_end;
  };
  /// The points p with normal . p >= offset.
  struct HalfSpace {
    Vec3 normal;
    double offset;
    bool at_far_end;
  };
  Gap gap(const Triangle& triangle, const Vec3& tip, const Vec3& end) const;
  void collect_near(const Vec3& axis, double reach);
  void linearise(const Vec3& axis, double reach);
  Vec3 nearest_in_half_spaces(const Vec3& wanted);
  bool project(const Vec3& wanted, Vec3& result) const;

  std::vector<Triangle> triangles_;
  RoundTool tool_;
  Vec3 free_ = Vec3::Zero();  ///< last free position [m]
  double error_ = 0.0;
  bool touched_far_end_ = false;
  // Indices of the triangles within near_reach_ [m] of the tool, at the position near_position_ with the axis
  // near_axis_.
  std::vector<std::uint32_t> near_;
  Vec3 near_position_ = Vec3::Zero(), near_axis_ = Vec3::Zero();
  double near_reach_ = -1.0;
  std::vector<HalfSpace> half_spaces_;
  std::vector<std::size_t> working_;  ///< working set: indices of the half-spaces that may bound the result
};

}  // namespace hapbench
