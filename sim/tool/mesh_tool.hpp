#pragma once

#include <memory>
#include <span>

#include "sim/tool/signed_distance_grid.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// A tool made of any closed mesh: the points where the field of a SignedDistanceGrid is <= 0. Uses the whole pose,
/// including the roll.
///
/// The search marks a point by the sign of the number whose negative is its depth, so both agree exactly. Depths are
/// within SignedDistanceGrid::error_bound() of the distance to the mesh, and within rounding of it over flats.
///
/// Convex meshes keep the proxy's guarantee: a point's constraint is the plane normal to the field's gradient that has
/// the whole mesh just behind it, whatever the gradient's error. For concave meshes it is the field's value, and a
/// proxy may enter points.
class MeshTool final : public ToolShape {
 public:
  /// Precondition: `grid` is not null.
  explicit MeshTool(std::shared_ptr<const SignedDistanceGrid> grid);

  const SignedDistanceGrid& grid() const noexcept { return *grid_; }
  bool convex() const noexcept override { return grid_->convex(); }
  bool is_axisymmetric() const noexcept override { return false; }
  double surface_error() const noexcept override { return grid_->error_bound(); }
  /// From the nodes in the body and their depths: at most a spacing too narrow.
  std::vector<ProfilePoint> outline() const override;

  void push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                   ContactBuffer& contacts) const noexcept override;
  /// Uses the nearest node alone. Let e = error_bound(). A point y of the grid within m of the body is within m of a
  /// place with phi_h <= 0, hence phi <= e; so phi(y) <= m + e, and its nearest node, which is within e, has
  /// phi <= m + 2 e. A point beyond the grid, which is convex and contains the body, is at least sqrt(a^2 + b^2) from
  /// the body, a being its distance from the grid and b that of its nearest place in the grid from the body.
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  /// A row of balls along the body's longest side.
  Cover cover(double margin) const override;
  /// A turn by an angle b moves a point by at most 2 sin(b/2) times its distance from the tip centre, and the rotation
  /// matrices differ by 2 sqrt(2) sin(b/2) in the Frobenius norm.
  double moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// Marches along the ray in steps too short to reach the surface (the field changes by at most sqrt(3) of the step),
  /// but at least an eighth of a spacing, so that thinner gaps are not seen, and refines the last one by regula falsi.
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  /// Depths and gradients of the field, for a concave body.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  /// Places of the mesh's convex hull; some 100 products for a contact of a smooth mesh, see SupportTable.
  void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                       const PlaceArrays& places) const noexcept override;
  /// Returns a cylinder around the body.
  Grown grown(double margin) const override;

 private:
  std::shared_ptr<const SignedDistanceGrid> grid_;
};

}  // namespace hapbench
