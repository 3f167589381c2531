#pragma once

#include <optional>
#include <vector>

#include "sim/geometry/solid.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// An upper bound of how deep a tool is in a solid (InsideSearch), by a dozen look-ups instead of hundreds, for many
/// poses of a run.
///
/// The tool lies in the body of revolution of its outline, and a stretch of that in a ball about any place of the axis
/// whose radius reaches to the stretch's furthest point. phi changes by at most the way between two points, so nothing
/// in a ball about c of radius R is deeper than R - phi(c), and after a move of the tool by no more than the way of c
/// besides. The smallest ball fits round tips and shanks; larger ones, about places ahead of the stretch and behind it,
/// touch a rim or a flat end along the surface's normal and so fit those at any tilt. A stretch that no ball settles is
/// halved.
class InsideBound {
 public:
  /// Both must outlive the bound.
  InsideBound(const ToolShape& tool, const Solid& solid);

  /// No point of the tool in this pose is deeper [m], nor in any other whose tip centre lies within `moved` [m] of this
  /// one's and whose axis differs by at most `turned` in length; negative where all are outside. A bound that is
  /// `enough` is not improved, nor, unless `best` is wanted, one of which it is clear that it will not be. Places of
  /// which nobody knows whether they are inside count as outside. Allocates when it looks at a stretch for the first
  /// time.
  double at(const ToolPose& pose, double moved, double turned, double enough, bool best);
  /// The same by the ball around the whole tool alone.
  double roughly_at(const ToolPose& pose, double moved, double turned);

  std::size_t looks() const noexcept { return looks_; }

 private:
  struct Ball {
    double place, radius;          ///< of its centre on the axis from the tip centre on [m]
    std::optional<LookedUp> near;  ///< where it was last, if that is known to be inside or outside
  };
  struct Stretch {
    double from, to;  ///< on the axis [m]
    std::vector<Ball> balls = {};
    std::size_t halves = 0;  ///< the first of two; 0 while there are none
  };
  struct Question {
    const ToolPose& pose;
    double moved, turned, enough;
    bool best;
  };
  double radius(const Stretch& stretch, double place) const;
  std::vector<Ball> balls_of(const Stretch& stretch) const;
  struct Look {
    double bound;  ///< by one ball [m]
    bool known;    ///< the solid knows its centre
  };
  Look look(Ball& ball, const Question& question);
  double of(std::size_t stretch, const Question& question);

  const ToolShape& tool_;
  const Solid& solid_;
  double half_width_;
  std::vector<ProfilePoint> outline_;
  double margin_;  ///< by which the body may reach beyond the outline [m]
  std::vector<Stretch> stretches_;
  std::size_t looks_ = 0;
};

}  // namespace hapbench
