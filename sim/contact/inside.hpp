#pragma once

#include <optional>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/geometry/solid.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

inline constexpr double kNormalsOver = 1e-3;  ///< share of a tool's half width over which normals are measured

/// How deep a tool is in a solid: the largest distance below its surface of any point of the tool, max(0, -phi) over
/// the tool's body. Not the depth of a contact, which ends at the tool's half width and is 0 for a tool that is inside
/// as a whole.
///
/// phi changes by at most the way between two points, so in a box of half diagonal R about c nothing is deeper than
/// R - phi(c). Boxes that the tool meets are halved until none can hold a point deeper by more than the tolerance than
/// the deepest one known. That one, at first the tip centre, is improved from where it was found: -grad phi leads to
/// the tool's foremost place in this direction, from which the way back is halved until the place is deeper. So the
/// answer is the exact depth of some point of the tool, as a rule the deepest.
///
/// Allocates in the constructor only. Some 100 to 1000 distances.
class InsideSearch {
 public:
  /// Both must outlive the search.
  InsideSearch(const ToolShape& tool, const Solid& solid);

  /// The depth [m]. None where the tip centre or the points that may be the deepest lie beyond the border of an open
  /// surface. `known`: a depth that is known of another pose, which is the answer unless the tool is deeper.
  /// `tolerance`: relative to the tool's half width; 2 % of the depth come on top.
  std::optional<double> depth(const ToolPose& pose, double known = 0.0, double tolerance = kTolerance) noexcept;

  static constexpr double kTolerance = 0.02;
  /// Additional depth error [m] from the tool's grid or from points that stand for a surface.
  double error() const noexcept { return error_; }
  std::size_t looks() const noexcept { return looks_; }  ///< distances of all searches so far, about

 private:
  struct Cell {
    Vec3 centre, half;
    double bound;     ///< of the depth in the cell [m]
    LookedUp looked;  ///< in it or in a cell that it is a part of
  };
  void look(const ToolPose& pose, const Cell* parents, std::size_t count) noexcept;
  bool may_be_deepest(double bound) const noexcept {
    return bound > best_ + tolerance_ * tool_.half_width() + kTolerance * best_;
  }
  bool into_tool(const ToolPose& pose, Vec3& point) noexcept;
  void improve(const ToolPose& pose, Vec3 place) noexcept;

  const ToolShape& tool_;
  const Solid& solid_;
  double error_;
  ContactBuffer points_;  ///< what the tool is asked about
  ContactBuffer one_;
  AlignedDoubles x_, y_, z_;  ///< an answer of the tool
  std::vector<Cell> cells_;   ///< that may hold the deepest point, as a stack
  double best_ = 0.0, tolerance_ = kTolerance;
  std::size_t looks_ = 0;
  bool beyond_border_ = false;  ///< a point there may be deeper
};

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
  /// `enough` is not improved, nor, unless `best` is wanted, one that clearly will not be. Unknown places count as
  /// outside. Allocates when it looks at a stretch for the first time.
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
