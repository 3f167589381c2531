#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/tool/meridian.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// A solid of revolution: burs, pins, cones, anything turned on a lathe. Its profile is a polyline in the axial half
/// plane from the shank's end to the tip. Where it ends off the axis, discs close it, or half a ball for a round tip:
///
///       rho
///        |      [1]________[2]
///        |       |           \.
///     [0]________|            \[3]       profile [0] … [3], s <= 0 everywhere; flat tip
///        |                      |
///     ---+----------------------+---> s
///     shank                     tip centre, s = 0
///
/// The body is the closed set on and below the profile. Undercuts are allowed, even if s decreases, as long as the
/// outline does not meet itself. A body that is not convex loses the proxy's guarantee: see surface_constraints.
///
/// The place of the surface nearest to a point lies in the point's own half plane, so depths and gradients are exact
/// distances to lines. With the profile [[-L, r], [0, r]] all answers are those of Cylinder up to rounding, except the
/// nearest place of a body shorter than its round tip's radius, which may be its rear, and the exit of a point on the
/// surface.
class Revolved final : public ToolShape {
 public:
  /// Throws what Meridian throws.
  explicit Revolved(std::vector<ProfilePoint> profile, Tip tip = Tip::flat);

  const std::vector<ProfilePoint>& profile() const noexcept { return meridian_.profile; }
  Tip tip() const noexcept { return meridian_.tip; }
  bool convex() const noexcept override { return meridian_.convex; }
  bool is_axisymmetric() const noexcept override { return true; }
  std::vector<ProfilePoint> outline() const override;

  void push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                   ContactBuffer& contacts) const noexcept override;
  /// Marks further than the margin at the edges of a convex body, but within the margin of the cylinder around it.
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  /// A row of balls along the axis.
  Cover cover(double margin) const override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// Ties prefer a round tip, then the profile's lines in order, then the tip, then the shank's end.
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// The first place where the ray goes out; 0 for a point on the surface whose ray points outwards.
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  /// Of a body that is not convex they only describe the approach of the nearest place: a long move may bring another
  /// part, such as an undercut's far side, to the point, and no face replaces an edge that would bump into it.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                       const PlaceArrays& places) const noexcept override;
  /// The convex hull of squares about the profile's points, whose corners reach sqrt(2) margin; a round tip stays round
  /// if the body is nowhere wider.
  Grown grown(double margin) const override;

 private:
  explicit Revolved(Meridian meridian);
  Meridian meridian_;
  double widest2_, ball2_;  ///< largest_square_within of the radii
};

}  // namespace hapbench
