#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/tool/meridian.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Solid of revolution, such as a bur, a pin or a cone. Its profile is a polyline in the axial half plane from the
/// shank's end to the tip. If an end of the profile is not on the axis, a disc closes the body at this end. If the tip
/// is round, a half ball closes the body at the tip:
///
///       rho
///        |      [1]________[2]
///        |       |           \.
///     [0]________|            \[3]       profile [0] … [3], s <= 0 everywhere; flat tip
///        |                      |
///     ---+----------------------+---> s
///     shank                     tip centre, s = 0
///
/// The body is the closed set on and below the profile. The profile may have undercuts, and s may decrease along it, as
/// long as the outline does not intersect itself. For a body that is not convex the proxy's guarantee does not hold:
/// see surface_constraints.
///
/// The closest point of the surface lies in the same axial half plane as the query point, so depths and gradients
/// are exact distances to line segments. With the profile [[-L, r], [0, r]] all results agree with Cylinder up to
/// rounding, with two exceptions. If a body with a round tip is shorter than its radius, the closest point of the
/// surface may be on the disc at the rear. The exit distance of a point on the surface may differ.
class Revolved final : public ToolShape {
 public:
  /// `profile`: points (s, rho) [m] from the shank's end to the tip. Throws the same errors as Meridian.
  explicit Revolved(std::vector<ProfilePoint> profile, Tip tip = Tip::flat);

  const std::vector<ProfilePoint>& profile() const noexcept { return meridian_.profile; }
  Tip tip() const noexcept { return meridian_.tip; }
  bool convex() const noexcept override { return meridian_.convex; }
  bool is_axisymmetric() const noexcept override { return true; }
  std::vector<ProfilePoint> outline() const override;

  void push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                   ContactBuffer& contacts) const noexcept override;
  /// Near the edges of a convex body, also marks points that are farther away than the margin. All marked points lie in
  /// the bounding cylinder of the body, enlarged by the margin.
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  /// Returns a row of balls along the axis.
  Cover cover(double margin) const override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// If several surfaces are equally near, prefers a round tip, then the profile's segments in order, then the
  /// tip's disc, then the shank's disc.
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// Returns the distance to the first point where the ray leaves the body; 0 for a point on the surface whose ray
  /// points outwards.
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  /// For a body that is not convex, the constraints only describe the distance to the closest point. After a long
  /// displacement of the body, the contact's point may be inside another part of the body, such as the far side of an
  /// undercut. In a body that is not convex, the constraint of a flush face (kFlush) does not replace the constraint of
  /// an edge.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  void support_points(const ToolPose& pose, const ContactBuffer& contacts,
                      const MutablePointArrays& surface_points) const noexcept override;
  /// Returns the convex hull of squares in the axial half plane. Each square is centred at a point of the profile, and
  /// its corners are sqrt(2) margin away from this point. A round tip stays round if no part of the body is wider than
  /// the tip.
  Grown grown(double margin) const override;

 private:
  explicit Revolved(Meridian meridian);
  Meridian meridian_;
  double widest2_, ball2_;  ///< squares of the radii `widest` and `ball`, rounded by largest_square_within() [m^2]
};

}  // namespace hapbench
