#pragma once

#include <cstddef>
#include <vector>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Cross product (b - a) x (c - a) in the plane (s, rho) [m^2]: > 0 if the path a, b, c turns from s towards rho, 0 if
/// the three points are in line.
double cross(const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c);

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

}  // namespace hapbench
