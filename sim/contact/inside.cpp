#include "sim/contact/inside.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Number of cells that are halved together. One call of ToolShape::surface_constraints() evaluates their eight halves.
constexpr std::size_t kAtOnce = 4;
/// Maximum size of the stack of cells. A cell is smaller than the tolerance after at most about 60 halvings, and each
/// round of the search adds at most kAtOnce cells.
constexpr std::size_t kMaxCells = 1024;
/// Maximum number of distance evaluations in one search, which bounds its time.
constexpr std::size_t kMaxEvaluations = 20000;
/// Lengths in units of the tool's half width. A point counts as in the tool if it is outside by at most kOnTool. Beyond
/// the border of an open surface, a cell with a half diagonal shorter than kCoarse is not halved further.
constexpr double kOnTool = 1e-9, kCoarse = 0.25;

/// Lengths in units of the tool's half width. A segment of the tool shorter than kShort is not halved. A segment longer
/// than kLong has a single ball around it; a shorter segment has several balls. kPolyline: largest distance between the
/// outline of a body of revolution and the polyline that represents this outline.
constexpr double kShort = 0.02, kLong = 1.0, kPolyline = 2e-4;
/// Distances along the axis from the centre of a segment's smallest ball to the centres of its other balls, positive
/// towards the shank, in units of the tool's half width.
constexpr double kCentreOffsets[] = {0.25, -0.25, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0, 4.0, -4.0, 8.0};

}  // namespace

InsideSearch::InsideSearch(const ToolShape& tool, const Solid& solid)
    : tool_(tool),
      solid_(solid),
      error_(solid.error() + tool.surface_error()),
      points_(2 * kAtOnce),
      one_(1),
      x_(2 * simd::lanes),
      y_(x_),
      z_(x_) {
  cells_.reserve(kMaxCells);
}

std::optional<double> InsideSearch::depth(const ToolPose& pose, double known, double tolerance) noexcept {
  best_ = known;
  evaluations_ += 8;  // about 8 evaluations: the tip centre and its improvement
  tolerance_ = tolerance;
  const SurfaceDistance tip = solid_.at(pose.position, tip_ ? &*tip_ : nullptr);
  const KnownDistance known_distance{pose.position, tip.value};
  tip_ = known_distance;
  beyond_border_ = !tip.known;
  cells_.clear();
  improve(pose, pose.position, known_distance);  // also finds depths smaller than the tolerance
  // Start with the box in which tool and solid may overlap.
  const Box box = tool_.box_near(pose, 0.0, solid_.region());
  const Vec3 low = box.min.cwiseMax(solid_.region().min), high = box.max.cwiseMin(solid_.region().max);
  if ((low.array() <= high.array()).all()) {
    const Vec3 half = 0.5 * (high - low);
    // This cell is halved first, so its depth bound may be coarse.
    cells_.push_back({0.5 * (low + high), half, std::abs(tip.value) + 2.0 * tool_.reach(), known_distance});
  }
  // Halve cells until none can hold a deeper point.
  for (std::size_t evaluated = 0; !cells_.empty() && evaluated < kMaxEvaluations; evaluated += 2 * kAtOnce) {
    std::array<Cell, kAtOnce> parents;
    std::size_t count = 0;
    while (count < kAtOnce && !cells_.empty()) {
      if (may_be_deepest(cells_.back().bound)) parents[count++] = cells_.back();
      cells_.pop_back();
    }
    halve(pose, parents.data(), count);
  }
  return best_ == 0.0 && beyond_border_ ? std::nullopt : std::optional(best_);
}

/// Halves the cells across their longest edges and keeps the halves that may hold a deeper point.
void InsideSearch::halve(const ToolPose& pose, const Cell* parents, std::size_t count) noexcept {
  // Halve the cells.
  std::array<Cell, 2 * kAtOnce> halves;
  points_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Index axis = 0;
    parents[i].half.maxCoeff(&axis);
    for (const double side : {-0.5, 0.5}) {
      Cell& half = halves[points_.size()] = parents[i];
      half.centre[axis] += side * half.half[axis];
      half.half[axis] *= 0.5;
      half.bound = solid_.max_depth_in({half.centre - half.half, half.centre + half.half});
      points_.push(0, half.centre, Vec3::UnitZ());
    }
  }
  if (points_.empty()) return;
  // Keep the halves that meet the tool and may hold a deeper point.
  tool_.surface_constraints(pose, Vec3::Zero(), 0.0, points_);
  const std::size_t first = cells_.size();
  for (std::size_t i = 0; i < points_.size(); ++i) examine(pose, halves[i], -points_.depth[i], points_.gradient(i));
  std::ranges::sort(cells_.begin() + static_cast<std::ptrdiff_t>(first), cells_.end(), {}, &Cell::bound);
}

/// Evaluates a cell, and keeps it if it meets the tool and may hold a deeper point. `outside`: distance of its centre
/// outside the tool [m]; `gradient`: unit vector along which this distance grows.
void InsideSearch::examine(const ToolPose& pose, Cell cell, double outside, const Vec3& gradient) noexcept {
  double radius = cell.half.norm();
  if (!(outside <= radius)) return;
  // Move the centre of the cell to the nearest point of the tool. For a convex body, this projection
  // increases no distance between points, so the radius stays valid.
  Vec3 point = cell.centre;
  if (outside > 0.0) {
    point -= outside * gradient;
    if (!tool_.convex()) radius += outside;
  }
  // Skip the cell if the known distance alone proves that it is not deep enough.
  const double distance = (point - cell.known_distance.point).norm();
  if (!may_be_deepest(radius + distance - cell.known_distance.value)) return;
  ++evaluations_;
  const SurfaceDistance phi = solid_.at(point, &cell.known_distance);
  if (phi.value >= radius) return;
  cell.known_distance = {point, phi.value};
  cell.bound = std::min(cell.bound, radius - phi.value);
  if (!may_be_deepest(cell.bound)) return;
  if (phi.known) {
    const bool is_deeper = -phi.value > best_ && (outside <= 0.0 || into_tool(pose, point));
    if (is_deeper) improve(pose, point, cell.known_distance);
  } else if (radius < kCoarse * tool_.half_width()) {
    beyond_border_ = beyond_border_ || phi.value < -best_;
    return;
  }
  if (cells_.size() < kMaxCells) cells_.push_back(cell);
}

/// Moves a point near the tool to the tool's surface, if the point is farther than kOnTool outside. Repeats the move,
/// because the distances of a mesh tool are approximate. Returns true if the point counts as in the tool at the start
/// or after at most two moves, and false otherwise. After a result of false, the caller must not use the point: it was
/// moved a third time, and this last position is not checked.
bool InsideSearch::into_tool(const ToolPose& pose, Vec3& point) noexcept {
  for (int round = 0; round < 3; ++round) {
    one_.clear();
    one_.push(0, point, Vec3::UnitZ());
    tool_.surface_constraints(pose, Vec3::Zero(), 0.0, one_);
    if (-one_.depth[0] <= kOnTool * tool_.half_width()) return true;
    point += one_.depth[0] * one_.gradient(0);
  }
  return false;
}

/// Moves from a point of the tool to deeper points of the tool and updates the largest depth. `near`: a point
/// near `point` and the signed distance at the near point.
void InsideSearch::improve(const ToolPose& pose, Vec3 point, const KnownDistance& near) noexcept {
  constexpr int kMoves = 8, kHalvings = 6;
  const MutablePointArrays answer{x_.data(), y_.data(), z_.data()};
  KnownDistance last{point, solid_.at(point, &near).value};
  const auto try_point = [&](Vec3 q) {
    if (!into_tool(pose, q)) return false;
    const SurfaceDistance phi = solid_.at(q, &last);
    last = {q, phi.value};
    if (!phi.known || !(-phi.value > best_)) return false;
    best_ = -phi.value;
    point = q;
    return true;
  };
  try_point(Vec3(point));
  // Move towards the support point along -grad phi; halve the move until the depth increases.
  for (int move = 0; move < kMoves; ++move) {
    one_.clear();
    one_.push(0, point, solid_.gradient(point, kGradientStep * tool_.half_width(), &last));
    tool_.support_points(pose, one_, answer);
    const Vec3 displacement = Vec3(x_[0], y_[0], z_[0]) - point;
    bool moved = false;
    double fraction = 1.0;
    for (int i = 0; i < kHalvings && !moved; ++i, fraction *= 0.5) moved = try_point(point + fraction * displacement);
    if (!moved) return;
  }
}

InsideBound::InsideBound(const ToolShape& tool, const Solid& solid)
    : tool_(tool),
      solid_(solid),
      half_width_(tool.half_width()),
      outline_(tool.outline()),
      // If the tool is sampled on a grid, its outline may be too narrow by up to the diagonal of a grid cell.
      margin_(kPolyline * half_width_ + 2.0 * tool.surface_error()) {
  const auto [far, tip] = std::ranges::minmax_element(outline_, {}, &ProfilePoint::s);
  segments_.push_back({far->s, tip->s});
}

/// Returns the distance from a position on the axis to the farthest point of the segment. The farthest point is a
/// point of the outline within the segment, or a point at which the outline crosses an end of the segment.
double InsideBound::radius(const Segment& segment, double position) const {
  double furthest = 0.0;
  for (std::size_t i = 0; i < outline_.size(); ++i) {
    const ProfilePoint& p = outline_[i];
    if (p.s >= segment.from && p.s <= segment.to) furthest = std::max(furthest, math::hypot(p.s - position, p.rho));
    if (i + 1 == outline_.size()) break;
    const ProfilePoint& q = outline_[i + 1];
    for (const double end : {segment.from, segment.to}) {
      if ((p.s - end) * (q.s - end) >= 0.0) continue;
      const double rho = p.rho + (end - p.s) / (q.s - p.s) * (q.rho - p.rho);
      furthest = std::max(furthest, math::hypot(end - position, rho));
    }
  }
  return furthest + margin_;
}

/// Returns the smallest ball around the segment and, for a short segment, further balls around it.
std::vector<InsideBound::Ball> InsideBound::balls_of(const Segment& segment) const {
  constexpr int kRounds = 24;  // each round keeps two thirds of the interval; 24 rounds leave 1e-4 of it
  double low = segment.from - half_width_, high = segment.to + half_width_;
  for (int i = 0; i < kRounds; ++i) {
    const double third = (high - low) / 3.0;
    // Ternary search: the distance from the centre to the farthest of several points is a convex function of the
    // centre.
    if (radius(segment, low + third) < radius(segment, high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  const double middle = 0.5 * (low + high);
  std::vector<Ball> balls = {{middle, radius(segment, middle), {}}};
  if (segment.to - segment.from > kLong * half_width_) return balls;
  for (const double offset : kCentreOffsets) {
    const double position = middle - offset * half_width_;
    balls.push_back({position, radius(segment, position), {}});
  }
  return balls;
}

/// Returns an upper bound of the depth from one ball. The bound comes from the signed distance at the ball's centre. A
/// bound is sufficient if it is at most `enough`. The distance from the last evaluation of the ball is used again if
/// the bound from it is sufficient. It is also used again if `best` is false and a new evaluation certainly cannot give
/// a sufficient bound.
InsideBound::Evaluation InsideBound::evaluate(Ball& ball, const BoundRequest& q) {
  const Vec3 centre = q.pose.position + ball.position * q.pose.axis;
  const double beyond = ball.radius + q.moved + std::abs(ball.position) * q.turned;
  if (ball.near) {
    const double distance = (centre - ball.near->point).norm(), bound = beyond - ball.near->value + distance;
    if (bound <= q.enough || (!q.best && bound - 2.0 * distance > q.enough)) return {bound, true};
  }
  ++evaluations_;
  const SurfaceDistance phi = solid_.at(centre, ball.near ? &*ball.near : nullptr);
  ball.near.reset();
  if (phi.known) ball.near = KnownDistance{centre, phi.value};
  return {beyond - phi.value, phi.known};
}

/// Returns the bound for segment k: the smallest bound of its balls, or the larger bound of its two halves if that is
/// smaller. Returns 0 if the segment is too short to be halved and no ball has a known distance.
double InsideBound::bound_of_segment(std::size_t k, const BoundRequest& request) {
  if (segments_[k].balls.empty()) segments_[k].balls = balls_of(segments_[k]);
  double smallest = std::numeric_limits<double>::infinity();
  bool known = false;
  for (Ball& ball : segments_[k].balls) {
    const Evaluation evaluation = evaluate(ball, request);
    known = known || evaluation.known;
    smallest = std::min(smallest, evaluation.bound);
    if (smallest <= request.enough) return smallest;
  }
  const double from = segments_[k].from, to = segments_[k].to;
  // Halve the segment if it is long enough.
  if (to - from < kShort * half_width_) return known ? smallest : 0.0;
  if (segments_[k].halves == 0) {
    segments_[k].halves = segments_.size();
    segments_.push_back({from, 0.5 * (from + to)});
    segments_.push_back({0.5 * (from + to), to});
  }
  const std::size_t halves = segments_[k].halves;
  const double front = bound_of_segment(halves + 1, request);
  if (front > request.enough && !request.best) return smallest;
  const double back = bound_of_segment(halves, request);
  return std::min(smallest, std::max(front, back));
}

double InsideBound::at(const ToolPose& pose, double moved, double turned, double enough, bool best) {
  const Box box = tool_.box_near(pose, moved + turned * tool_.reach(), solid_.region());
  if ((box.min.array() > box.max.array()).any()) return 0.0;
  const double in_box = solid_.max_depth_in(box);
  return in_box <= enough ? in_box : std::min(in_box, bound_of_segment(0, {pose, moved, turned, enough, best}));
}

double InsideBound::coarse_bound_at(const ToolPose& pose, double moved, double turned) {
  if (segments_[0].balls.empty()) segments_[0].balls = balls_of(segments_[0]);
  return evaluate(segments_[0].balls.front(), {pose, moved, turned, 0.0, true}).bound;
}

}  // namespace hapbench
