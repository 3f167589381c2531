#pragma once

#include <vector>

#include "sim/tool/meridian.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// A solid of revolution: burs, pins, cones, anything turned on a lathe. Its profile is a polyline in the axial half
/// plane, s along the axis and rho away from it, from the shank's end to the tip; where it ends off the axis, discs
/// close it, or half a ball a round tip:
///
///       rho
///        |      [1]________[2]
///        |       |           \.
///     [0]________|            \[3]       profile [0] … [3], s <= 0 everywhere; flat tip
///        |                      |
///     ---+----------------------+---> s
///     shank                     tip centre, s = 0
///
/// The body is the closed set on and below the profile. A turn about the axis changes nothing. Undercuts are fine, even
/// such that s goes back, as long as the outline does not meet itself; Meridian lists what is refused.
///
/// The place of the surface that is nearest to a point lies in the point's own half plane, so depths and gradients come
/// from distances to lines, exactly; of a point inside a convex body those to the lines it lies on are enough. With the
/// profile [[-L, r], [0, r]] all answers are Cylinder's, up to rounding, but for two: the rear of a round tip shorter
/// than its radius counts here as what it is, perhaps the nearest place; and the exit of a point on the surface.
///
/// A body that is not convex loses the proxy's guarantee: see surface_constraints.
class Revolved final : public ToolShape {
 public:
  /// Throws std::invalid_argument that names what is wrong with the profile and at which point.
  explicit Revolved(std::vector<ProfilePoint> profile, Tip tip = Tip::flat);

  const std::vector<ProfilePoint>& profile() const noexcept { return meridian_.profile; }
  Tip tip() const noexcept { return meridian_.tip; }
  bool convex() const noexcept override { return meridian_.convex; }
  std::vector<ProfilePoint> outline() const override;

  void mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                   std::uint8_t* marks) const noexcept override;
  void push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                   ContactBuffer& contacts) const noexcept override;
  /// Not rounded at the edges of a convex body, but never further than the margin from the cylinder around it.
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  /// In a row along the axis, as far apart as they are wide.
  Cover cover(double margin) const override;
  double moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// Ties prefer a round tip, then the profile's lines in their order, then the tip, then the shank's end.
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// The first place where the ray goes out; 0 of a point on the surface from where the ray goes out.
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  /// Of a body that is not convex signed distance and outward normal at the nearest place, too. They say how the
  /// nearest place comes closer and no more: a long move may lead another part of the body, an undercut's far side,
  /// into the point, and no face takes the place of an edge that it would bump into.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                       const PlaceArrays& places) const noexcept override;
  /// Around the convex hull, with corners that reach sqrt(2) margin.
  Grown grown(double margin) const override;

 private:
  explicit Revolved(Meridian meridian);
  template <class Use>
  void with_test(const Use& use) const;

  Meridian meridian_;
  double widest2_;  ///< largest squares that count as within, see largest_square_within
  double ball2_;
};

}  // namespace hapbench
