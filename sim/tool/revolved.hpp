#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The half plane <n, (s, rho)> <= offset.
struct HalfPlane {
  double ns, nr;  ///< outward unit normal
  double offset;  ///< [m]

  /// Distance of a place inside from the boundary [m]; negative outside.
  double slack(double s, double rho) const noexcept { return offset - ns * s - nr * rho; }
};

/// The outline of a solid of revolution in the axial half plane, from the shank's end to the tip, closed by discs where
/// it ends off the axis, in the form that search and depths loop over.
struct Meridian {
  /// Throws std::invalid_argument that names the first wrong point: fewer than two points, a number that is not finite,
  /// s > 0, rho < 0, a point on the axis that is neither the first nor the last, a repeated point, lines that go back
  /// on themselves or meet others, a tip behind the shank's end, or, for a round tip, a last point with s other than
  /// 0, where the tip centre is. O(n^2).
  Meridian(std::vector<ProfilePoint> points, Tip end);

  /// A line of the outline: the boundary of its half plane from `start` on, in the direction (nr, -ns).
  struct Line : HalfPlane {
    double start;   ///< coordinate of its first place along its direction [m]
    double length;  ///< [m]
  };
  /// The line rho = at_tip + slope s.
  struct Height {
    double at_tip;  ///< [m]
    double slope;
  };
  /// A convex region: the places with low <= s <= high on and below heights[first] … heights[last - 1]; with
  /// `above_last`, on and above the last of these.
  struct Part {
    double low, high;
    std::size_t first, last;
    bool above_last;
  };

  std::vector<ProfilePoint> profile;
  Tip tip;
  std::vector<Line> lines;  ///< of the profile, then the tip's disc, then the shank's
  /// The section with s <= 0, cut into convex parts at the profile's corners that turn inwards.
  std::vector<Part> parts;
  std::vector<Height> heights;
  std::vector<HalfPlane> planes;  ///< of a convex body: bounded by the profile's lines; without the discs
  bool convex = false;            ///< corners that turn inwards by less than 1e-12 rad count as straight
  double low, high;               ///< range of s, without the ball of a round tip
  double widest = 0.0;            ///< largest rho
  double reach = 0.0;             ///< distance of the furthest place from the tip centre
  double ball = 0.0;              ///< radius of a round tip; 0 for a flat one

 private:
  void add_lines();
  void add_parts();
};

/// A convex profile around everything within `margin` >= 0 of the body: the convex hull of squares about the profile's
/// points. It may reach beyond s = 0; a round tip stays round if the body is nowhere wider.
std::pair<std::vector<ProfilePoint>, Tip> grown_profile(const Meridian& meridian, double margin);

/// A solid of revolution: burs, pins, cones, anything turned on a lathe. Its profile is a polyline in the axial half
/// plane, s along the axis and rho away from it, from the shank's end to the tip. Where it ends off the axis, discs
/// close it, or half a ball for a round tip:
///
///       rho
///        |      [1]________[2]
///        |       |           \.
///     [0]________|            \[3]       profile [0] … [3], s <= 0 everywhere; flat tip
///        |                      |
///     ---+----------------------+---> s
///     shank                     tip centre, s = 0
///
/// The body is the closed set on and below the profile. A turn about the axis changes nothing. Undercuts are allowed,
/// even if s decreases, as long as the outline does not meet itself; Meridian lists what is refused.
///
/// The place of the surface nearest to a point lies in the point's own half plane, so depths and gradients are exact
/// distances to lines. With the profile [[-L, r], [0, r]] all answers are those of Cylinder up to rounding, with two
/// exceptions: the rear of a body shorter than its round tip's radius may be the nearest place, and the exit of a point
/// on the surface.
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
  /// Marks further than the margin at the edges of a convex body, but within the margin of the cylinder around it.
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  /// A row of balls along the axis.
  Cover cover(double margin) const override;
  double moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// Ties prefer a round tip, then the profile's lines in order, then the tip, then the shank's end.
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// The first place where the ray goes out; 0 for a point on the surface whose ray points outwards.
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  /// Signed distance and outward normal at the nearest place, also for a body that is not convex. They only describe
  /// the approach of that place: a long move may bring another part of the body, such as an undercut's far side, to the
  /// point, and no face replaces an edge that would bump into it.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                       const PlaceArrays& places) const noexcept override;
  /// Contains the convex hull; its corners reach sqrt(2) margin.
  Grown grown(double margin) const override;

 private:
  explicit Revolved(Meridian meridian);
  template <class Use>
  void with_test(const Use& use) const;

  Meridian meridian_;
  double widest2_, ball2_;  ///< largest_square_within of the radii
};

}  // namespace hapbench
