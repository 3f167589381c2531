#pragma once

#include <memory>
#include <span>

#include "sim/tool/signed_distance_grid.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Tool with the shape of any closed mesh: the points where the field of a SignedDistanceGrid is <= 0. Uses the
/// whole pose, including the roll.
///
/// The depth of a point is minus the field's value, and the contact search tests the sign of the same value, so both
/// agree exactly. A depth differs from the distance to the mesh by at most SignedDistanceGrid::error_bound(). Where the
/// closest part of the mesh is flat, away from edges, the depth differs from this distance only by rounding.
///
/// For a convex mesh the proxy's guarantee (ToolShape::surface_constraints) holds whatever the error of the
/// gradient: the constraint of a point is the plane that is normal to the field's gradient and touches the mesh
/// from outside. For a concave mesh the constraint is the field's value, and points may be inside the proxy.
class MeshTool final : public ToolShape {
 public:
  /// Precondition: `grid` is not null.
  explicit MeshTool(std::shared_ptr<const SignedDistanceGrid> grid);

  const SignedDistanceGrid& grid() const noexcept { return *grid_; }
  bool convex() const noexcept override { return grid_->convex(); }
  bool is_axisymmetric() const noexcept override { return false; }
  double surface_error() const noexcept override { return grid_->error_bound(); }
  /// Computes the outline from the nodes in the body and their depths; the outline is up to one grid spacing too
  /// narrow.
  std::vector<ProfilePoint> outline() const override;

  void push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                   ContactBuffer& contacts) const noexcept override;
  /// Tests the value of the nearest node only. phi and phi_h are the exact and the interpolated field
  /// (SignedDistanceGrid). Let e = error_bound() and m = margin. A point y in the grid within m of the body is within
  /// m of a point with phi_h <= 0, where phi <= e. Hence phi(y) <= m + e, and the nearest node, whose distance from y
  /// is at most e, has phi <= m + 2 e. The grid is convex and contains the body. A point outside of the grid is
  /// therefore at least sqrt(a^2 + b^2) away from the body. Here a is its distance from the grid, and b the distance
  /// of the closest point of the grid from the body.
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  /// Returns a row of balls along the longest side of the body's box.
  Cover cover(double margin) const override;
  /// A rotation by an angle b moves a point by at most 2 sin(b/2) times its distance from the tip centre. The
  /// Frobenius norm of the difference of the rotation matrices is 2 sqrt(2) sin(b/2), from which the bound follows.
  double displacement_bound(const ToolPose& from, const ToolPose& to) const noexcept override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// Marches along the ray and refines the last step by regula falsi. The field changes by at most sqrt(3) times the
  /// length of a step, so the steps are chosen too short to cross the surface. No step is shorter than an eighth of the
  /// grid spacing. A step of this minimum length may cross the surface and miss a gap that is thinner than the step.
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  /// For a concave body the constraints are the depths and gradients of the field.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  /// Returns points of the mesh's convex hull. Costs about 100 dot products for each contact of a smooth mesh; see
  /// SupportTable.
  void support_points(const ToolPose& pose, const ContactBuffer& contacts,
                      const MutablePointArrays& surface_points) const noexcept override;
  /// Returns a cylinder around the body.
  Grown grown(double margin) const override;

 private:
  std::shared_ptr<const SignedDistanceGrid> grid_;
};

}  // namespace hapbench
