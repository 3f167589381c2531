#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Half plane <n, (s, rho)> <= offset in axial coordinates (s along the axis, rho distance from the axis).
struct HalfPlane {
  double ns, nr;  ///< outward unit normal
  double offset;  ///< distance of the boundary from the origin [m]

  /// Returns the distance from a point inside to the boundary [m]; negative outside. `Number` is a double or a pack
  /// of eight.
  template <class Number>
  Number slack(const Number& s, const Number& rho) const noexcept {
    return Number(offset) - Number(ns) * s - Number(nr) * rho;
  }
};

/// Closed outline of a solid of revolution, prepared for the loops of contact search and depths. Where the profile
/// ends off the axis, a disc closes it.
struct Meridian {
  /// `points`: profile from the shank's end to the tip. Throws std::invalid_argument that names the first invalid
  /// point: fewer than two points, a number that is not finite, s > 0, rho < 0, a point on the axis that is neither
  /// the first nor the last, a repeated point, lines that fold back or intersect, a tip behind the shank's end, or,
  /// for a round tip, a last point with s other than 0 (the tip centre). O(n^2).
  Meridian(std::vector<ProfilePoint> points, Tip end);

  /// Line segment of the outline, on the boundary of a half plane whose normal points out of the body. The segment
  /// begins at coordinate `start` along the direction (nr, -ns).
  struct Line : HalfPlane {
    double start;   ///< coordinate of its first point along its direction [m]
    double length;  ///< length of the segment [m]
  };
  /// Line rho = at_tip + slope s.
  struct Height {
    double at_tip;  ///< rho at s = 0 [m]
    double slope;
  };
  /// Convex region of the section: the points with low <= s <= high that lie on or below all lines heights[first] …
  /// heights[last - 1]. If `above_last` is set, the points lie on or above the last of these lines instead.
  struct Part {
    double low, high;
    std::size_t first, last;
    bool above_last;
  };

  std::vector<ProfilePoint> profile;
  Tip tip;
  std::vector<Line> lines;  ///< segments of the profile, then of the tip's disc, then of the shank's disc
  /// Section of the body with s <= 0, divided into convex regions at the profile's corners that turn inwards.
  std::vector<Part> parts;
  /// Upper and lower lines of all parts.
  std::vector<Height> heights;
  std::vector<HalfPlane> planes;  ///< half planes of the profile's segments if the body is convex, without the discs
  bool convex = false;            ///< corners that turn inwards by less than 1e-12 rad count as straight
  double low, high;               ///< range of s [m], without the ball of a round tip
  double widest = 0.0;            ///< largest rho [m]
  double reach = 0.0;             ///< distance from the tip centre to the farthest point [m]
  double ball = 0.0;              ///< radius of a round tip [m]; 0 for a flat tip

 private:
  void add_lines();
  void add_parts();
};

/// Solid of revolution, such as a bur, a pin or a cone. Its profile is a polyline in the axial half plane from the
/// shank's end to the tip. Where the profile ends off the axis, discs close the body, or a half ball for a round
/// tip:
///
///       rho
///        |      [1]________[2]
///        |       |           \.
///     [0]________|            \[3]       profile [0] … [3], s <= 0 everywhere; flat tip
///        |                      |
///     ---+----------------------+---> s
///     shank                     tip centre, s = 0
///
/// The body is the closed set on and below the profile. Undercuts are allowed, also where s decreases, as long as
/// the outline does not intersect itself. For a body that is not convex the proxy's guarantee does not hold: see
/// surface_constraints.
///
/// The closest point of the surface lies in the same axial half plane as the query point, so depths and gradients
/// are exact distances to line segments. With the profile [[-L, r], [0, r]] all results agree with Cylinder up to
/// rounding, with two exceptions: the closest point of a body shorter than the radius of its round tip may be on
/// its rear, and the exit of a point on the surface may differ.
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
  /// At the edges of a convex body also marks points farther away than the margin, but only points within the
  /// margin of the cylinder around the body.
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
  /// For a body that is not convex, the constraints only describe the distance to the closest point. A long
  /// displacement may bring another part of the body to the point, such as the far side of an undercut. No flush
  /// face replaces an edge.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                       const PlaceArrays& places) const noexcept override;
  /// Returns the convex hull of squares about the profile's points, whose corners are sqrt(2) margin away from the
  /// points. A round tip stays round if no part of the body is wider than the tip.
  Grown grown(double margin) const override;

 private:
  explicit Revolved(Meridian meridian);
  Meridian meridian_;
  double widest2_, ball2_;  ///< largest_square_within of the radii `widest` and `ball` [m^2]
};

/// Shapes of dental rotary instruments, with the names of ISO 6360-2.
enum class BurFamily { ball, cylinder, round_cylinder, tapered, inverted_cone, pear, flame };

/// Profile and tip of a bur: the arguments of Revolved.
struct BurProfile {
  std::vector<ProfilePoint> profile;
  Tip tip;
};

/// Returns the profile of a bur with its shank. All lengths in m and > 0:
///
/// - diameter: largest diameter of the head, the nominal size of ISO 6360 (a "012" has 1.2 mm).
/// - length: length of the head along the axis, from its front end (including the half ball of a round tip) to the
/// beginning of the shank. For a ball bur it equals the diameter; the neck hides a small part of the ball at the
/// rear.
/// - shank_diameter: diameter of the cylinder behind the head, called neck if it is thin. The shank is ten times as
/// long.
///
/// | family | head, from the shank to the tip | tip centre |
/// |---|---|---|
/// | ball | a ball | centre of the ball |
/// | cylinder | a cylinder with a flat end | centre of the end |
/// | round_cylinder | a cylinder with a half ball at its end | centre of the ball |
/// | tapered | a cone frustum that narrows to 0.6 of the diameter, flat end | centre of the end |
/// | inverted_cone | a cone frustum that widens from 0.6 of the diameter, flat end | centre of the end |
/// | pear | a cone that widens from the shank and touches the ball at its end | centre of the ball |
/// | flame | two arcs: from the shank to the diameter in the rear third, and from there to a point | the point |
///
/// Arcs are polylines with corners on the arc and a sagitta (largest deviation from the arc) of at most a
/// thousandth of the diameter. Throws std::invalid_argument with the allowed range if a length is invalid for the
/// family.
BurProfile bur_profile(BurFamily family, double diameter, double length, double shank_diameter);

}  // namespace hapbench
