#include "sim/contact/inside_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Relative to the half width: stretches this short are not halved, ones this long have one ball only; what outlines
/// made of polylines leave out of round bodies.
constexpr double kShort = 0.02, kLong = 1.0, kPolyline = 2e-4;
/// Centres beside that of the smallest ball, in half widths.
constexpr double kBeside[] = {0.25, -0.25, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0, 4.0, -4.0, 8.0};

}  // namespace

InsideBound::InsideBound(const ToolShape& tool, const Solid& solid)
    : tool_(tool),
      solid_(solid),
      half_width_(tool.half_width()),
      outline_(tool.outline()),
      // The outline of a tool on a grid may leave out a cell's diagonal.
      margin_(kPolyline * half_width_ + 2.0 * tool.surface_error()) {
  const auto [far, tip] = std::minmax_element(outline_.begin(), outline_.end(),
                                              [](const ProfilePoint& a, const ProfilePoint& b) { return a.s < b.s; });
  stretches_.push_back({far->s, tip->s});
}

/// Distance from a place of the axis to the furthest point of the stretch: one of the outline's points in it or where
/// the outline crosses its ends.
double InsideBound::radius(const Stretch& stretch, double place) const {
  double furthest = 0.0;
  for (std::size_t i = 0; i < outline_.size(); ++i) {
    const ProfilePoint& p = outline_[i];
    if (p.s >= stretch.from && p.s <= stretch.to) furthest = std::max(furthest, math::hypot(p.s - place, p.rho));
    if (i + 1 == outline_.size()) break;
    const ProfilePoint& q = outline_[i + 1];
    for (const double end : {stretch.from, stretch.to}) {
      if ((p.s - end) * (q.s - end) >= 0.0) continue;
      const double rho = p.rho + (end - p.s) / (q.s - p.s) * (q.rho - p.rho);
      furthest = std::max(furthest, math::hypot(end - place, rho));
    }
  }
  return furthest + margin_;
}

std::vector<InsideBound::Ball> InsideBound::balls_of(const Stretch& stretch) const {
  constexpr int kRounds = 24;  // each leaves two thirds of the way: to 1e-4 of it
  double low = stretch.from - half_width_, high = stretch.to + half_width_;
  for (int i = 0; i < kRounds; ++i) {
    const double third = (high - low) / 3.0;
    // The distance to the furthest of some points is convex.
    if (radius(stretch, low + third) < radius(stretch, high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  const double middle = 0.5 * (low + high);
  std::vector<Ball> balls = {{middle, radius(stretch, middle), {}}};
  if (stretch.to - stretch.from > kLong * half_width_) return balls;
  for (const double beside : kBeside) {
    const double place = middle - beside * half_width_;
    balls.push_back({place, radius(stretch, place), {}});
  }
  return balls;
}

/// The bound by one ball, without a look where the last one tells that this is enough or, if only enough will do,
/// cannot be.
InsideBound::Look InsideBound::look(Ball& ball, const Question& q) {
  const Vec3 centre = q.pose.position + ball.place * q.pose.axis;
  const double beyond = ball.radius + q.moved + std::abs(ball.place) * q.turned;
  if (ball.near) {
    const double way = (centre - ball.near->place).norm(), bound = beyond - ball.near->value + way;
    if (bound <= q.enough || (!q.best && bound - 2.0 * way > q.enough)) return {bound, true};
  }
  ++looks_;
  const SurfaceDistance phi = solid_.at(centre, ball.near ? &*ball.near : nullptr);
  ball.near.reset();
  if (phi.known) ball.near = LookedUp{centre, phi.value};
  return {beyond - phi.value, phi.known};
}

double InsideBound::of(std::size_t k, const Question& question) {
  if (stretches_[k].balls.empty()) stretches_[k].balls = balls_of(stretches_[k]);
  double least = std::numeric_limits<double>::infinity();
  bool known = false;
  for (Ball& ball : stretches_[k].balls) {
    const Look look_here = look(ball, question);
    known = known || look_here.known;
    least = std::min(least, look_here.bound);
    if (least <= question.enough) return least;
  }
  const double from = stretches_[k].from, to = stretches_[k].to;
  if (to - from < kShort * half_width_) return known ? least : 0.0;
  if (stretches_[k].halves == 0) {
    stretches_[k].halves = stretches_.size();
    stretches_.push_back({from, 0.5 * (from + to)});
    stretches_.push_back({0.5 * (from + to), to});
  }
  const std::size_t halves = stretches_[k].halves;
  const double front = of(halves + 1, question);
  if (front > question.enough && !question.best) return least;
  const double back = of(halves, question);
  return std::min(least, std::max(front, back));
}

double InsideBound::at(const ToolPose& pose, double moved, double turned, double enough, bool best) {
  const Box box = tool_.box_near(pose, moved + turned * tool_.reach(), solid_.region());
  if ((box.min.array() > box.max.array()).any()) return 0.0;
  const double in_box = solid_.deepest_in(box);
  return in_box <= enough ? in_box : std::min(in_box, of(0, {pose, moved, turned, enough, best}));
}

double InsideBound::roughly_at(const ToolPose& pose, double moved, double turned) {
  if (stretches_[0].balls.empty()) stretches_[0].balls = balls_of(stretches_[0]);
  return look(stretches_[0].balls.front(), {pose, moved, turned, 0.0, true}).bound;
}

}  // namespace hapbench
