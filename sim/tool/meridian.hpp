#pragma once

#include <cstddef>
#include <vector>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Returns the cross product of b - a and c - a in the plane (s, rho) [m^2]; positive if c is to the left of the line
/// from a to b, 0 if the three points are collinear.
double cross(const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c);

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

/// Closed outline of a solid of revolution, prepared for the loops of contact search and depths. If an end of the
/// profile is not on the axis, a disc closes the outline at this end.
struct Meridian {
  /// `points`: profile from the shank's end to the tip. Throws std::invalid_argument that names the first invalid
  /// point: fewer than two points, a number that is not finite, s > 0, rho < 0, a point on the axis that is neither
  /// the first nor the last, a repeated point, lines that fold back or intersect, a tip behind the shank's end, or,
  /// for a round tip, a last point with s other than 0 (the tip centre). O(n^2).
  Meridian(std::vector<ProfilePoint> points, Tip end);

  /// Line segment of the outline, on the boundary of a half plane whose normal points out of the body. The segment
  /// begins at coordinate `start` along the direction (nr, -ns).
  struct Line : HalfPlane {
    double start;   ///< coordinate of the segment's first point along this direction [m]
    double length;  ///< length of the segment [m]
  };
  /// Line rho = at_tip + slope s.
  struct Height {
    double at_tip;  ///< rho at s = 0 [m]
    double slope;
  };
  /// Convex region of the section: the points with low <= s <= high that lie on or below all lines heights[first] …
  /// heights[last - 1]. If `above_last` is true, the points lie on or above line heights[last - 1], and on or below all
  /// others.
  struct Part {
    double low, high;
    std::size_t first, last;
    bool above_last;
  };

  std::vector<ProfilePoint> profile;
  Tip tip;
  std::vector<Line> lines;  ///< segments of the profile, then of the tip's disc, then of the shank's disc
  /// The half s <= 0 of the body's meridian cross-section, divided into convex regions at the concave corners of the
  /// profile.
  std::vector<Part> parts;
  /// Upper and lower lines of all parts.
  std::vector<Height> heights;
  std::vector<HalfPlane> planes;  ///< half planes of the profile's segments, without the discs; empty if not convex
  bool convex = false;            ///< true if no corner turns inwards by more than 1e-12 rad
  double low, high;               ///< range of s [m], without the ball of a round tip
  double widest = 0.0;            ///< largest rho [m]
  double reach = 0.0;             ///< distance from the tip centre to the farthest point [m]
  double ball = 0.0;              ///< radius of a round tip [m]; 0 for a flat tip

 private:
  void add_lines();
  void add_parts();
};

}  // namespace hapbench
