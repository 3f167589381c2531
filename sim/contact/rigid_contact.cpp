#include "sim/contact/rigid_contact.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hapbench {
namespace {

/// A search ends after a move of at most kAtRest times the tool's radius, or after kMaxMoves moves. Positions in scenes
/// of centimetres have rounding errors of about 1e-16 m, which is 2e-13 times a radius of half a millimetre.
constexpr double kAtRest = 1e-12;
constexpr int kMaxMoves = 200;
/// A half-space is violated if a point is outside by more than this [m].
constexpr double kPlaneRounding = 1e-16;
constexpr std::size_t kMaxWorking = 24;

/// Closest points of the tool's segment and of a triangle or an edge.
struct Pair {
  Vec3 on_tool, on_triangle;
  double fraction;  ///< position of the point on the tool's segment: 0 at the tip centre, 1 at the far end
};

/// Returns the closest points of the segments p q and a b (C. Ericson, Real-Time Collision Detection, 2005, 5.1.9).
Pair closest_of_segments(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const Vec3 along = q - p, edge = b - a, from = p - a;
  const double pp = along.squaredNorm(), ee = edge.squaredNorm(), f = edge.dot(from);
  double s = 0.0, t = 0.0;
  if (pp == 0.0) {
    t = ee > 0.0 ? std::clamp(f / ee, 0.0, 1.0) : 0.0;
  } else {
    const double c = along.dot(from);
    if (ee == 0.0) {
      s = std::clamp(-c / pp, 0.0, 1.0);
    } else {
      const double both = along.dot(edge), area = pp * ee - both * both;
      s = area > 0.0 ? std::clamp((both * f - c * ee) / area, 0.0, 1.0) : 0.0;
      t = (both * s + f) / ee;
      if (t < 0.0 || t > 1.0) {
        t = std::clamp(t, 0.0, 1.0);
        s = std::clamp((both * t - c) / pp, 0.0, 1.0);
      }
    }
  }
  return {p + s * along, a + t * edge, s};
}

/// Returns the distance of a point from the segment p q [m].
double distance_to_segment(const Vec3& point, const Vec3& p, const Vec3& q) {
  const Vec3 along = q - p;
  const double length2 = along.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((point - p).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - p - s * along).norm();
}

}  // namespace

RigidContact::RigidContact(TriangleSoup surface, const RoundTool& tool) : tool_(tool) {
  triangles_.reserve(surface.triangles.size());
  for (const auto& [i, j, k] : surface.triangles) {
    const Vec3 &a = surface.vertices[i], &b = surface.vertices[j], &c = surface.vertices[k];
    const Vec3 centre = (a + b + c) / 3.0;
    const double radius = std::max({(a - centre).norm(), (b - centre).norm(), (c - centre).norm()});
    triangles_.push_back({a, b, c, centre, radius});
  }
}

/// Returns the Gap between a triangle and the tool's segment, which has the ends `tip` and `end`. Precondition: the
/// segment does not cross the triangle.
RigidContact::Gap RigidContact::gap(const Triangle& t, const Vec3& tip, const Vec3& end) const {
  Pair best{};
  double smallest = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Pair& pair) {
    const double distance2 = (pair.on_tool - pair.on_triangle).squaredNorm();
    if (distance2 >= smallest) return;
    smallest = distance2;
    best = pair;
  };
  // The closest point of the triangle lies on an edge, or it is the foot of the perpendicular from an end of the
  // segment.
  for (const auto& [a, b] : {std::pair(&t.a, &t.b), {&t.b, &t.c}, {&t.c, &t.a}})
    consider(closest_of_segments(tip, end, *a, *b));
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
  const double area2 = normal.squaredNorm();
  for (const auto& [point, fraction] : {std::pair(&tip, 0.0), {&end, 1.0}}) {
    if (area2 == 0.0) break;
    const Vec3 foot = *point - (*point - t.a).dot(normal) / area2 * normal;
    const bool is_within = (t.b - t.a).cross(foot - t.a).dot(normal) >= 0.0 &&
                           (t.c - t.b).cross(foot - t.b).dot(normal) >= 0.0 &&
                           (t.a - t.c).cross(foot - t.c).dot(normal) >= 0.0;
    if (is_within) consider({*point, foot, fraction});
  }
  const double distance = std::sqrt(smallest);
  const Vec3 away = unit_or(best.on_tool - best.on_triangle, Vec3::Zero());
  return {distance, away, best.fraction == 1.0 && tool_.length > 0.0};
}

/// Collects the triangles that the tool may touch while it moves by at most `reach` from the free position.
void RigidContact::collect_near(const Vec3& axis, double reach) {
  const double moved = (free_ - near_position_).norm() + tool_.length * (axis - near_axis_).norm();
  if (reach + moved <= near_reach_) return;
  near_reach_ = 2.0 * (reach + tool_.radius);
  near_position_ = free_;
  near_axis_ = axis;
  near_.clear();
  const Vec3 end = free_ - tool_.length * axis;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    const Triangle& t = triangles_[i];
    if (distance_to_segment(t.centre, free_, end) <= t.radius + tool_.radius + near_reach_) near_.push_back(i);
  }
}

/// Linearises the tool's distance from each triangle that the tool may touch within `reach` of the free position.
void RigidContact::linearise(const Vec3& axis, double reach) {
  collect_near(axis, reach);
  half_spaces_.clear();
  const Vec3 end = free_ - tool_.length * axis;
  for (const std::uint32_t i : near_) {
    const Triangle& t = triangles_[i];
    if (distance_to_segment(t.centre, free_, end) > t.radius + tool_.radius + reach) continue;
    const Gap found = gap(t, free_, end);
    const double room = found.distance - tool_.radius;
    if (room > reach || found.normal.isZero(0.0)) continue;
    half_spaces_.push_back({found.normal, found.normal.dot(free_) - room, found.at_far_end});
  }
}

/// Projects `wanted` onto the intersection of the half-spaces of the working set. For this, finds up to three of their
/// planes such that the projection of `wanted` onto the intersection of these planes lies in all half-spaces of the
/// working set, with multipliers >= 0. Returns false if no such planes exist.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): loops over one, two and three planes.
bool RigidContact::project(const Vec3& wanted, Vec3& result) const {
  const std::size_t n = working_.size();
  const auto plane = [this](std::size_t i) -> const HalfSpace& { return half_spaces_[working_[i]]; };
  const auto is_solution = [&](const std::array<std::size_t, 3>& of, int count) {
    Eigen::Matrix<double, 3, 3> normals = Eigen::Matrix<double, 3, 3>::Identity();
    Vec3 offsets = Vec3::Zero();
    for (int k = 0; k < count; ++k) {
      normals.row(k) = plane(of[static_cast<std::size_t>(k)]).normal.transpose();
      offsets[k] = plane(of[static_cast<std::size_t>(k)]).offset - normals.row(k).dot(wanted);
    }
    const auto used = normals.topRows(count);
    const Eigen::MatrixXd gram = used * used.transpose();
    const Eigen::FullPivLU<Eigen::MatrixXd> solver(gram);
    if (!solver.isInvertible()) return false;
    const Eigen::VectorXd multipliers = solver.solve(offsets.head(count));
    if ((multipliers.array() < 0.0).any()) return false;
    const Vec3 candidate = wanted + used.transpose() * multipliers;
    for (std::size_t i = 0; i < n; ++i)
      if (plane(i).normal.dot(candidate) < plane(i).offset - 10.0 * kPlaneRounding) return false;
    result = candidate;
    return true;
  };
  for (std::size_t i = 0; i < n; ++i)
    if (is_solution({i, 0, 0}, 1)) return true;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (is_solution({i, j, 0}, 2)) return true;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k)
        if (is_solution({i, j, k}, 3)) return true;
  return false;
}

/// Returns the point nearest to `wanted` that lies in all half-spaces. Repeatedly adds the half-space that the result
/// violates most to the working set, until the result violates none. Returns the last free position if rounding
/// prevents a solution or the working set is full.
Vec3 RigidContact::nearest_in_half_spaces(const Vec3& wanted) {
  working_.clear();
  Vec3 result = wanted;
  while (working_.size() < kMaxWorking) {
    double worst = -kPlaneRounding;
    std::size_t add = half_spaces_.size();
    for (std::size_t i = 0; i < half_spaces_.size(); ++i) {
      const double room = half_spaces_[i].normal.dot(result) - half_spaces_[i].offset;
      if (room >= worst || std::ranges::count(working_, i) > 0) continue;
      worst = room;
      add = i;
    }
    if (add == half_spaces_.size()) return result;
    working_.push_back(add);
    if (!project(wanted, result)) break;
  }
  return free_;
}

bool RigidContact::start(const Vec3& position, const Vec3& axis) {
  free_ = position;
  linearise(axis, tool_.radius);
  return std::ranges::all_of(half_spaces_, [this](const HalfSpace& h) { return h.normal.dot(free_) >= h.offset; });
}

Vec3 RigidContact::follow(const Vec3& position, const Vec3& axis) {
  double last_move = 0.0;
  for (int i = 0; i < kMaxMoves; ++i) {
    linearise(axis, (position - free_).norm() + tool_.radius);
    const Vec3 next = nearest_in_half_spaces(position);
    const double move = (next - free_).norm();
    free_ = next;
    const bool rests = move <= kAtRest * tool_.radius;
    if (rests || i + 1 == kMaxMoves) {
      // Estimate the error: the moves shrink like a geometric series, so the sum of all further moves is bounded.
      const double ratio = last_move > 0.0 ? std::min(move / last_move, 0.999) : 0.0;
      error_ = std::max(error_, move / (1.0 - ratio) + kAtRest * tool_.radius);
      break;
    }
    last_move = move;
  }
  for (const std::size_t i : working_) touched_far_end_ = touched_far_end_ || half_spaces_[i].at_far_end;
  return free_;
}

}  // namespace hapbench
