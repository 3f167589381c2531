#pragma once

#include <optional>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/geometry/solid.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Step of the central differences that compute the gradient of the signed distance phi, relative to the tool's half
/// width.
inline constexpr double kGradientStep = 1e-3;

/// Computes how deep a tool is inside a solid: the largest value of max(0, -phi) over all points of the tool, where phi
/// is the signed distance to the solid's surface, negative inside the solid. The depth of a contact is another
/// quantity: it is at most the tool's half width, and there is no contact if the whole tool is inside the solid.
///
/// Method (branch and bound): phi changes by at most the distance between two points, so no point in a box with
/// centre c and half diagonal R is deeper than R - phi(c). Boxes that meet the tool are halved until none can
/// hold a point that is deeper than the best known point by more than the tolerance. The best known point, at
/// first the tip centre, is improved whenever a deeper point is found: the search moves from it towards the
/// tool's support point (extreme point) along -grad phi and halves the move until the depth increases. The
/// result is therefore the exact depth of one point of the tool, usually the deepest point.
///
/// Allocates in the constructor only. One search evaluates about 100 to 1000 distances.
class InsideSearch {
 public:
  /// Tool and solid must outlive the search.
  InsideSearch(const ToolShape& tool, const Solid& solid);

  /// Returns the depth [m] of the deepest point found, or `known` if that is larger. `known` [m]: a depth found in
  /// another pose. Returns nullopt instead of 0 if the tip centre, or a point that may be inside, lies beyond the
  /// border of an open surface, where inside and outside are unknown. `tolerance`: largest error of the result, in
  /// units of the tool's half width; an error of 2 % of the depth is allowed in addition.
  std::optional<double> depth(const ToolPose& pose, double known = 0.0, double tolerance = kTolerance) noexcept;

  /// Default of the argument `tolerance`. The same number is the relative error of the depth that is allowed in
  /// addition.
  static constexpr double kTolerance = 0.02;
  /// Returns the error of the depth [m] that adds to the tolerance if the tool is sampled on a grid or points represent
  /// the surface; 0 otherwise.
  double error() const noexcept { return error_; }
  /// Approximate number of distances evaluated in all searches so far.
  std::size_t looks() const noexcept { return evaluations_; }

 private:
  /// A box of the search and the upper bound of the depth in it.
  struct Cell {
    Vec3 centre, half;
    double bound;                  ///< upper bound of the depth in the cell [m]
    KnownDistance known_distance;  ///< signed distance at a point of this cell, or of a cell that contains this cell
  };
  void halve(const ToolPose& pose, const Cell* parents, std::size_t count) noexcept;
  void examine(const ToolPose& pose, Cell cell, double outside, const Vec3& gradient) noexcept;
  bool may_be_deepest(double bound) const noexcept {
    return bound > best_ + tolerance_ * tool_.half_width() + kTolerance * best_;
  }
  bool into_tool(const ToolPose& pose, Vec3& point) noexcept;
  void improve(const ToolPose& pose, Vec3 point, const KnownDistance& near) noexcept;

  const ToolShape& tool_;
  const Solid& solid_;
  double error_;
  ContactBuffer points_;      ///< points at which the tool is evaluated together
  ContactBuffer one_;         ///< single point at which the tool is evaluated
  AlignedDoubles x_, y_, z_;  ///< support point returned by the tool
  std::vector<Cell> cells_;   ///< stack of cells that may hold the deepest point
  /// Depth of the deepest point found so far [m], and the tolerance of the current search.
  double best_ = 0.0, tolerance_ = kTolerance;
  std::size_t evaluations_ = 0;
  std::optional<KnownDistance> tip_;  ///< signed distance at the tip centre of the last search
  /// True if the tip centre, or a point that may be deeper than the deepest point found, is beyond the border of an
  /// open surface.
  bool beyond_border_ = false;
};

/// Upper bound of the depth of a tool in a solid (InsideSearch), from a dozen distance evaluations instead of
/// hundreds. Used for many poses of a run.
///
/// The tool lies in the body of revolution of its outline. Each segment of this body along the axis lies in a
/// ball around any centre on the axis, if the radius reaches the segment's farthest point. The signed distance
/// phi changes by at most the distance between two points, so no point in a ball of radius R around c is deeper
/// than R - phi(c). When the tool moves, the bound grows by at most the displacement of c. The bound of a ball is close
/// to the depth if the deepest points of ball and tool are close to each other. The smallest ball has such a bound for
/// round tips and shanks. At a rim or a flat end, one of several larger balls has such a bound; their centres are ahead
/// of or behind the segment, and the tilt of the tool determines which ball is best. A segment for which no ball gives
/// a sufficient bound is halved.
class InsideBound {
 public:
  /// Tool and solid must outlive the bound.
  InsideBound(const ToolShape& tool, const Solid& solid);

  /// Returns an upper bound [m] of the depth of every point of the tool, negative if all points are outside. The bound
  /// holds for this pose, and for every pose whose tip centre is at most `moved` [m] away and whose axis differs from
  /// this unit axis by a vector of at most the length `turned`. A bound <= `enough` [m] is not improved. With `best`
  /// false, a bound that clearly cannot fall to `enough` is not improved either. Points at which the solid's inside is
  /// unknown count as outside. Allocates when it uses a segment of the tool for the first time.
  double at(const ToolPose& pose, double moved, double turned, double enough, bool best);
  /// Returns a coarser bound with the same meaning, from one ball around the whole tool.
  double coarse_bound_at(const ToolPose& pose, double moved, double turned);

  /// Number of distances evaluated so far.
  std::size_t looks() const noexcept { return evaluations_; }

 private:
  /// A ball around a segment of the tool.
  struct Ball {
    double position, radius;            ///< position of the centre on the axis, from the tip centre [m]; radius [m]
    std::optional<KnownDistance> near;  ///< last evaluated centre; empty if the solid did not know its distance
  };
  /// A segment of the tool along its axis.
  struct Segment {
    double from, to;  ///< ends on the axis, from the tip centre [m]
    std::vector<Ball> balls = {};
    std::size_t halves = 0;  ///< index of the first of its two halves; 0 if it is not halved
  };
  /// The arguments of `at`.
  struct BoundRequest {
    const ToolPose& pose;
    double moved, turned, enough;
    bool best;
  };
  double radius(const Segment& segment, double position) const;
  std::vector<Ball> balls_of(const Segment& segment) const;
  struct Evaluation {
    double bound;  ///< upper bound from one ball [m]
    bool known;    ///< true if the solid can determine whether the ball's centre is inside
  };
  Evaluation evaluate(Ball& ball, const BoundRequest& request);
  double bound_of_segment(std::size_t segment, const BoundRequest& request);

  const ToolShape& tool_;
  const Solid& solid_;
  double half_width_;
  std::vector<ProfilePoint> outline_;
  double margin_;  ///< distance by which the body may extend beyond the outline [m]
  std::vector<Segment> segments_;
  std::size_t evaluations_ = 0;
};

}  // namespace hapbench
