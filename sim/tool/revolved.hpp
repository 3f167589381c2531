#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The half plane <n, (s, rho)> <= offset.
struct HalfPlane {
  double ns, nr;  ///< outward unit normal
  double offset;  ///< [m]

  /// Distance of a place inside from the boundary [m], or of eight; negative outside.
  template <class Number>
  Number slack(const Number& s, const Number& rho) const noexcept {
    return Number(offset) - Number(ns) * s - Number(nr) * rho;
  }
};

/// The outline of a solid of revolution, closed by discs where it ends off the axis, as search and depths loop over it.
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

/// The shapes of rotary instruments that ISO 6360-2 numbers and dentists know by these names.
enum class BurFamily { ball, cylinder, round_cylinder, tapered, inverted_cone, pear, flame };

/// The arguments of Revolved.
struct BurProfile {
  std::vector<ProfilePoint> profile;
  Tip tip;
};

/// The profile of a bur with its shank. Lengths in metres, all > 0:
///
/// - diameter: the largest of the head, ISO 6360's nominal size (a "012" has 1.2 mm);
/// - length: of the head along the axis, from the foremost place to where the shank begins, including half a ball at
/// the
///   tip. For a ball bur it is the diameter, from which the neck cuts a little off at the rear;
/// - shank_diameter: of the cylinder behind the head, called neck if it is thin; the shank is ten times as long.
///
/// | family | head, from the shank to the tip | tip centre |
/// |---|---|---|
/// | ball | a ball | the ball's centre |
/// | cylinder | a cylinder with a flat end | the end's centre |
/// | round_cylinder | a cylinder with half a ball at its end | the ball's centre |
/// | tapered | a cone frustum that narrows to 0.6 of the diameter, flat end | the end's centre |
/// | inverted_cone | a cone frustum that widens from 0.6 of the diameter, flat end | the end's centre |
/// | pear | widens from the shank along a cone that touches the ball at its end | the ball's centre |
/// | flame | two arcs: from the shank to the diameter in the rear third, and from there to a point | the point |
///
/// Arcs are polylines with their corners on the arc and a sagitta of at most a thousandth of the diameter. Throws
/// std::invalid_argument that says which length does not suit the family.
BurProfile bur_profile(BurFamily family, double diameter, double length, double shank_diameter);

}  // namespace hapbench
