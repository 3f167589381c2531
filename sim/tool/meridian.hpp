#pragma once

#include <cstddef>
#include <vector>

#include "sim/tool/profile_point.hpp"
#include "sim/tool/tip.hpp"

namespace hapbench {

/// The half plane <n, (s, rho)> <= offset.
struct HalfPlane {
  double ns, nr;  ///< outward unit normal
  double offset;  ///< [m]

  /// How far a place lies inside.
  double slack(double s, double rho) const noexcept { return offset - ns * s - nr * rho; }
};

/// The outline of a solid of revolution in the axial half plane, from the shank's end to the tip, closed by discs where
/// it ends off the axis. What the search and the depths loop over.
struct Meridian {
  /// Throws std::invalid_argument that names the first point of which something is wrong: fewer than two points, a
  /// number that is not finite, s > 0, rho < 0, a point on the axis that is neither the first nor the last, a point
  /// twice, lines that go back on themselves or meet others, a tip behind the shank's end, and of a round tip a last
  /// point that is not beside the tip centre. O(n^2).
  Meridian(std::vector<ProfilePoint> points, Tip end);

  /// A line of the outline: the boundary of its half plane from `start` on, in the direction (nr, -ns).
  struct Line : HalfPlane {
    double start;   ///< of the line's first place, in its direction [m]
    double length;  ///< [m]
  };
  /// The line rho = at_tip + slope s.
  struct Height {
    double at_tip;  ///< [m]
    double slope;
  };
  /// The places with low <= s <= high on and below some heights, and on and above one if there is any: convex.
  struct Part {
    double low, high;
    std::size_t first, last;  ///< of `heights`
    bool above_last;          ///< the last one is that to be above
  };

  std::vector<ProfilePoint> profile;
  Tip tip;
  std::vector<Line> lines;  ///< those of the profile, then the tip's disc, then the shank's
  /// The section with s <= 0, cut into convex parts at the profile's corners that turn inwards.
  std::vector<Part> parts;
  std::vector<Height> heights;
  std::vector<HalfPlane> planes;  ///< of a convex body: those on whose boundary the profile lies, ends excepted
  bool convex;                    ///< the body; corners that turn inwards by less than 1e-12 rad count as straight
  double low, high;               ///< range of s; of a flat tip's body, or of the section behind a round tip
  double widest;                  ///< largest rho
  double reach;                   ///< distance of the furthest place from the tip centre
  double ball;                    ///< radius of a round tip; 0 of a flat one

 private:
  void add_lines();
  void add_parts();
};

/// A convex profile around everything within `margin` >= 0 of the body, perhaps a little larger: the convex hull of
/// squares about the profile's points. It may reach beyond s = 0; a round tip stays one if the body is nowhere wider.
struct GrownProfile {
  std::vector<ProfilePoint> points;
  Tip tip;
};
GrownProfile grown_profile(const Meridian& meridian, double margin);

}  // namespace hapbench
