#pragma once

#include <memory>

#include "sim/tool/signed_distance_grid.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// A tool of any closed mesh: the points where the field of a SignedDistanceGrid is <= 0. It reads all of the pose,
/// roll and all.
///
/// The search marks a point by the sign of the very number whose negative is its depth, so both agree to the bit.
/// Depths are within SignedDistanceGrid::error_bound() of the distance to the mesh, and within rounding of it over
/// flats.
///
/// Convex meshes keep the proxy's guarantee: a point's constraint is the plane along the field's gradient that just
/// leaves the whole mesh behind it, whatever the gradient's error. For concave ones it is the field's value, and a
/// proxy may enter points.
class MeshTool final : public ToolShape {
 public:
  /// Precondition: there is a grid.
  explicit MeshTool(std::shared_ptr<const SignedDistanceGrid> grid);

  const SignedDistanceGrid& grid() const noexcept { return *grid_; }
  bool convex() const noexcept override { return grid_->convex(); }
  /// Of the nodes in the body, each with the way that it still is from the surface: at most a spacing too narrow.
  std::vector<ProfilePoint> outline() const override;

  void mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                   std::uint8_t* marks) const noexcept override;
  void push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                   ContactBuffer& contacts) const noexcept override;
  /// By the nearest node alone. A point y of the grid within m of the body has a place of phi_h <= 0, so of phi <= e =
  /// error_bound(), within m, hence phi(y) <= m + e, and its nearest node, which is within e, phi <= m + 2 e. A point
  /// beyond the grid, which is convex and holds the body, is further from it than sqrt(a^2 + b^2), a its distance from
  /// the grid and b that of its nearest place there from the body.
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  /// In a row along the body's longest side.
  Cover cover(double margin) const override;
  /// A turn by an angle b moves a point by at most 2 sin(b/2) times its distance from the tip centre, and the matrices
  /// differ by 2 sqrt(2) sin(b/2) (Frobenius).
  double moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// Goes along the ray by ways too short to reach the surface (the field changes by at most sqrt(3) of the way) but at
  /// least an eighth of a spacing, below which thickness holes are not seen, and then halves the last one by regula
  /// falsi.
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  /// Of a convex body; of a concave one depths and gradients of the field.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  /// Of the mesh's convex hull: some 100 products for a contact of a smooth mesh, see SupportTable.
  void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                       const PlaceArrays& places) const noexcept override;
  /// A cylinder around the body.
  Grown grown(double margin) const override;

 private:
  std::shared_ptr<const SignedDistanceGrid> grid_;
};

}  // namespace hapbench
