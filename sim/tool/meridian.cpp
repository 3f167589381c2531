#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "sim/core/math.hpp"
#include "sim/tool/refuse.hpp"
#include "sim/tool/revolved.hpp"

namespace hapbench {
namespace {

/// Sine of the largest angle by which a corner may turn inwards and still count as straight.
constexpr double kStraight = 1e-12;

/// Returns the cross product of b - a and c - a; positive if c is to the left of the line from a to b.
double cross(const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c) {
  return (b.s - a.s) * (c.rho - a.rho) - (b.rho - a.rho) * (c.s - a.s);
}

/// Returns the dot product of b - a and c - b.
double dot(const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c) {
  return (b.s - a.s) * (c.s - b.s) + (b.rho - a.rho) * (c.rho - b.rho);
}

/// Returns true if c lies between a and b. Precondition: the three points are collinear.
bool between(const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c) {
  return std::min(a.s, b.s) <= c.s && c.s <= std::max(a.s, b.s) && std::min(a.rho, b.rho) <= c.rho &&
         c.rho <= std::max(a.rho, b.rho);
}

/// Returns true if the segments a b and c d have a point in common.
bool meet(const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c, const ProfilePoint& d) {
  const double abc = cross(a, b, c), abd = cross(a, b, d), cda = cross(c, d, a), cdb = cross(c, d, b);
  const auto apart = [](double x, double y) { return (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0); };
  if (apart(abc, abd) && apart(cda, cdb)) return true;
  return (abc == 0.0 && between(a, b, c)) || (abd == 0.0 && between(a, b, d)) || (cda == 0.0 && between(c, d, a)) ||
         (cdb == 0.0 && between(c, d, b));
}

/// Validates a profile given by a user, and throws with the first error.
class Checker {
 public:
  Checker(const std::vector<ProfilePoint>& points, Tip tip) : points_(points), tip_(tip) {}

  void check() const {
    if (points_.size() < 2) {
      hapbench::refuse("a profile needs at least two points, from the shank's end to the tip");
    }
    for (std::size_t i = 0; i < points_.size(); ++i) check_point(i);
    const std::size_t last = points_.size() - 1;
    if (tip_ == Tip::round && (points_[last].s != 0.0 || points_[last].rho == 0.0)) {
      refuse(last,
             "a round tip is half a ball about the tip centre, so the profile has to end beside it: s = 0, rho > 0");
    }
    if (!(points_[0].s < points_[last].s)) {
      refuse(last, "a profile runs from the shank's end to the tip, so its last s has to be larger than its first");
    }
    check_corners();
    check_crossings();
  }

 private:
  /// Segment of the closed outline between two corners. The corners on the axis have the numbers -1 (shank) and
  /// size() (tip).
  struct Edge {
    std::ptrdiff_t from, to;
  };

  void check_point(std::size_t i) const {
    const ProfilePoint& p = points_[i];
    if (!std::isfinite(p.s) || !std::isfinite(p.rho)) refuse(i, "both numbers have to be finite");
    if (p.s > 0.0) refuse(i, "s has to be <= 0: the tip centre has s = 0, and the shank lies behind it");
    if (p.rho < 0.0) refuse(i, "rho, the distance from the axis, has to be >= 0");
    if (i > 0 && p.rho == 0.0 && points_[i - 1].rho == 0.0)
      refuse(i, "on the axis as the point before: no body between");
    const bool inner = i > 0 && i + 1 < points_.size();
    if (inner && p.rho == 0.0) refuse(i, "only the first and the last point may lie on the axis");
    if (i > 0 && p == points_[i - 1]) refuse(i, "the same as the point before");
  }

  /// Returns the segments of the closed outline.
  std::vector<Edge> edges() const {
    const auto n = static_cast<std::ptrdiff_t>(points_.size());
    std::vector<Edge> all;
    if (points_.front().rho > 0.0) all.push_back({-1, 0});
    for (std::ptrdiff_t i = 0; i + 1 < n; ++i) all.push_back({i, i + 1});
    // The half ball of a round tip may be wider than the body behind it. The disc that closes the tip then begins
    // at the corner before.
    const bool overhangs = tip_ == Tip::round && points_[points_.size() - 2].s == 0.0 &&
                           points_[points_.size() - 2].rho < points_.back().rho;
    if (points_.back().rho > 0.0) all.push_back({overhangs ? n - 2 : n - 1, n});
    return all;
  }

  ProfilePoint corner(std::ptrdiff_t i) const {
    if (i < 0) return {points_.front().s, 0.0};
    if (i == static_cast<std::ptrdiff_t>(points_.size())) return {points_.back().s, 0.0};
    return points_[static_cast<std::size_t>(i)];
  }

  /// Throws if two consecutive segments fold back on each other.
  void check_corners() const {
    const std::vector<Edge> all = edges();
    for (std::size_t k = 0; k + 1 < all.size(); ++k) {
      if (all[k].to != all[k + 1].from) continue;
      const ProfilePoint a = corner(all[k].from), b = corner(all[k].to), c = corner(all[k + 1].to);
      const double forwards = dot(a, b, c);
      if (forwards < 0.0 && std::abs(cross(a, b, c)) <= -kStraight * forwards) {
        refuse(static_cast<std::size_t>(all[k].to), "here the profile goes back on itself");
      }
    }
  }

  /// Throws if two segments that are not neighbours intersect.
  void check_crossings() const {
    const std::vector<Edge> all = edges();
    for (std::size_t k = 0; k < all.size(); ++k) {
      for (std::size_t j = 0; j < k; ++j) {
        const Edge a = all[j], b = all[k];
        if (a.to == b.from || a.from == b.from) continue;
        if (!meet(corner(a.from), corner(a.to), corner(b.from), corner(b.to))) continue;
        refuse(static_cast<std::size_t>(std::max<std::ptrdiff_t>(b.from, 0)),
               joined("the ", name(b), " meets the ", name(a), ", so that the profile crosses or touches itself"));
      }
    }
  }

  std::string name(const Edge& edge) const {
    if (edge.from < 0) return "disc that closes the shank's end";
    if (edge.to == static_cast<std::ptrdiff_t>(points_.size())) return "disc that closes the tip";
    return joined("line from profile[", edge.from, "] to profile[", edge.to, "]");
  }

  [[noreturn]] void refuse(std::size_t i, const std::string& why) const {
    hapbench::refuse("profile[", i, "] = [", points_[i].s, ", ", points_[i].rho, "] m: ", why);
  }

  const std::vector<ProfilePoint>& points_;
  Tip tip_;
};

/// Returns the segment from a to b with the body on its right.
Meridian::Line line_between(const ProfilePoint& a, const ProfilePoint& b) {
  const double length = math::hypot(b.s - a.s, b.rho - a.rho);
  const double ns = -(b.rho - a.rho) / length, nr = (b.s - a.s) / length;
  return {{ns, nr, ns * a.s + nr * a.rho}, nr * a.s - ns * a.rho, length};
}

constexpr double kSagittaPerDiameter = 1e-3;
constexpr double kShankPerDiameter = 10.0;
constexpr double kNarrowEnd = 0.6;  ///< narrow end of tapered and inverted cones, relative to the wide end
constexpr double kRearOfFlame = 1.0 / 3.0;

[[noreturn]] void refuse_length(const char* what, double is, const char* has_to, double bound) {
  refuse(what, " is ", is, " m and has to be ", has_to, ' ', bound, " m");
}

/// Profile under construction, from the shank's end to the tip.
class Outline {
 public:
  Outline(double diameter, double shank_radius, double head_begins) : sagitta_(kSagittaPerDiameter * diameter) {
    points_ = {{head_begins - 2.0 * kShankPerDiameter * shank_radius, shank_radius}, {head_begins, shank_radius}};
  }

  /// Adds a segment to this point, unless the profile already ends there.
  void line_to(double s, double rho) {
    if (points_.back() != ProfilePoint{s, rho}) points_.push_back({s, rho});
  }

  /// Adds an arc about (centre_s, centre_rho) from angle `from` to the smaller angle `to`, both measured from the
  /// axis [rad]. The arc ends exactly at `end`.
  void arc_to(double centre_s, double centre_rho, double radius, double from, double to, const ProfilePoint& end) {
    // A chord over the angle a has the sagitta radius (1 - cos(a / 2)).
    const double widest = 2.0 * math::acos(std::max(0.0, 1.0 - sagitta_ / radius));
    const double count = std::ceil((from - to) / widest);
    for (double k = 1.0; k < count; k += 1.0) {
      const double angle = from + (to - from) * k / count;
      line_to(centre_s + radius * math::cos(angle), centre_rho + radius * math::sin(angle));
    }
    line_to(end.s, end.rho);
  }

  std::vector<ProfilePoint> points() && { return std::move(points_); }

 private:
  double sagitta_;
  std::vector<ProfilePoint> points_;
};

constexpr double kAbreast = 0.5 * std::numbers::pi;  ///< angle of the point beside a circle's centre [rad]

/// Returns a ball on a neck of radius `neck`.
BurProfile ball(double radius, double neck) {
  const double begins = -std::sqrt((radius - neck) * (radius + neck));
  Outline outline(2.0 * radius, neck, begins);
  outline.arc_to(0.0, 0.0, radius, math::atan2(neck, begins), kAbreast, {0.0, radius});
  return {std::move(outline).points(), Tip::round};
}

/// Returns a cone frustum from s = `begins` to the tip centre, with the radii `rear` and `front` at its ends.
BurProfile frustum(double begins, double rear, double front, double shank, Tip tip) {
  Outline outline(2.0 * std::max(rear, front), shank, begins);
  outline.line_to(begins, rear);
  outline.line_to(0.0, front);
  return {std::move(outline).points(), tip};
}

/// Returns a cone that widens from the shank at (begins, neck) and touches the ball. It touches at the angle
/// `touches` from the axis: its unit normal n = (cos touches, sin touches) satisfies <n, (begins, neck)> = radius.
BurProfile pear(double radius, double length, double neck) {
  const double begins = radius - length;
  const double distance = math::hypot(begins, neck);
  if (distance <= radius)
    refuse_length("the length of a pear bur", length, "more than",
                  radius + std::sqrt((radius - neck) * (radius + neck)));
  const double touches = math::atan2(neck, begins) - math::acos(radius / distance);
  Outline outline(2.0 * radius, neck, begins);
  outline.line_to(radius * math::cos(touches), radius * math::sin(touches));
  outline.arc_to(0.0, 0.0, radius, touches, kAbreast, {0.0, radius});
  return {std::move(outline).points(), Tip::round};
}

/// Returns two arcs: from the shank to the largest radius, and from there to the point. An arc that is parallel to
/// the axis at its highest point and falls by h over the length l has the radius (l^2 + h^2) / (2 h).
BurProfile flame(double radius, double length, double neck) {
  const double rear = kRearOfFlame * length, front = length - rear, rise = radius - neck;
  if (rise > rear || radius > front)
    refuse_length("the length of a flame bur", length, "at least", 3.0 * std::max(rise, 0.5 * radius));
  Outline outline(2.0 * radius, neck, -length);
  const double rear_arc = (rear * rear + rise * rise) / (2.0 * rise);
  outline.arc_to(-front, radius - rear_arc, rear_arc, kAbreast + math::asin(rear / rear_arc), kAbreast,
                 {-front, radius});
  const double front_arc = (front * front + radius * radius) / (2.0 * radius);
  outline.arc_to(-front, radius - front_arc, front_arc, kAbreast, kAbreast - math::asin(front / front_arc), {0.0, 0.0});
  return {std::move(outline).points(), Tip::flat};
}

}  // namespace

Meridian::Meridian(std::vector<ProfilePoint> points, Tip end) : profile(std::move(points)), tip(end) {
  Checker(profile, tip).check();
  low = high = profile.front().s;
  for (const ProfilePoint& p : profile) {
    low = std::min(low, p.s);
    high = std::max(high, p.s);
    widest = std::max(widest, p.rho);
    reach = std::max(reach, math::hypot(p.s, p.rho));
  }
  if (tip == Tip::round) ball = profile.back().rho;
  add_lines();
  add_parts();
}

void Meridian::add_lines() {
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) lines.push_back(line_between(profile[i], profile[i + 1]));
  const ProfilePoint first = profile.front(), last = profile.back();
  if (tip == Tip::flat && last.rho > 0.0) lines.push_back(line_between(last, {last.s, 0.0}));
  if (first.rho > 0.0) lines.push_back(line_between({first.s, 0.0}, first));
}

/// Divides the section into convex parts. First cuts it into trapezoids between consecutive values of s at the
/// corners. Then joins a trapezoid to the part that ends where the trapezoid begins, if both have the same lower
/// line and the upper line of the trapezoid continues the part's upper line without turning inwards.
void Meridian::add_parts() {
  struct Built {
    double low, high;
    std::optional<std::size_t> below;  ///< its lower line; none if the part reaches the axis
    std::vector<std::size_t> above;    ///< its upper lines, in order
  };
  // Values of s at which trapezoids begin and end.
  std::vector<double> levels;
  for (const ProfilePoint& p : profile) levels.push_back(p.s);
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());

  const std::size_t of_profile = profile.size() - 1;
  const auto height = [this](std::size_t i, double s) { return (lines[i].offset - lines[i].ns * s) / lines[i].nr; };
  const auto goes_on = [this](std::size_t from, std::size_t to) {
    return from == to || (to == from + 1 && lines[from].ns * lines[to].nr - lines[from].nr * lines[to].ns <= kStraight);
  };
  std::vector<Built> built;
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    const double from = levels[k], to = levels[k + 1], middle = 0.5 * (from + to);
    // Find the lines across this interval, from the axis outwards.
    std::vector<std::size_t> across;
    for (std::size_t i = 0; i < of_profile; ++i) {
      const auto [least, most] = std::minmax(profile[i].s, profile[i + 1].s);
      if (least <= from && most >= to) across.push_back(i);
    }
    std::ranges::sort(across, {}, [&](std::size_t i) { return height(i, middle); });
    // Pair each upper line with the lower line below it, and join the trapezoid to a part or begin a new part.
    std::optional<std::size_t> below;
    for (const std::size_t i : across) {
      if (lines[i].nr < 0.0) {
        below = i;
        continue;
      }
      const auto part = std::find_if(built.begin(), built.end(), [&](const Built& p) {
        return p.high == from && p.below == below && goes_on(p.above.back(), i);
      });
      if (part == built.end()) {
        built.push_back({from, to, below, {i}});
      } else {
        part->high = to;
        if (part->above.back() != i) part->above.push_back(i);
      }
      below.reset();
    }
  }
  // Store the lines of the parts.
  const auto add_height = [this](std::size_t i) {
    const ProfilePoint a = profile[i], b = profile[i + 1];
    const double slope = (b.rho - a.rho) / (b.s - a.s);
    heights.push_back({a.rho - slope * a.s, slope});
  };
  for (const Built& part : built) {
    const std::size_t first = heights.size();
    for (const std::size_t i : part.above) add_height(i);
    if (part.below) add_height(*part.below);
    parts.push_back({part.low, part.high, first, heights.size(), part.below.has_value()});
  }
  // The body is convex if it is one part above the axis, and a round tip continues it without turning inwards.
  const Line& last = lines[of_profile - 1];
  convex = built.size() == 1 && !built[0].below && (tip == Tip::flat || (last.nr > 0.0 && last.ns <= kStraight));
  if (!convex) return;
  for (const std::size_t i : built[0].above) planes.push_back(lines[i]);
}

// Defined here and not in revolved.cpp, because it is not called in the step loop.
ToolShape::Grown Revolved::grown(double margin) const {
  const bool round = tip() == Tip::round && meridian_.widest <= meridian_.ball;
  std::vector<ProfilePoint> corners;
  const auto add_square = [&](double s, double rho) {
    corners.push_back({s - margin, rho + margin});
    if (!round) corners.push_back({s + margin, rho + margin});
  };
  for (const ProfilePoint& p : profile()) add_square(p.s, p.rho);
  // No part of the body is wider than the ball, so everything behind the centre of the ball is below the rear
  // corners of the squares.
  if (round) corners.push_back({0.0, meridian_.ball + margin});
  if (!round && tip() == Tip::round) add_square(meridian_.ball, meridian_.ball);

  std::sort(corners.begin(), corners.end(),
            [](const ProfilePoint& a, const ProfilePoint& b) { return a.s < b.s || (a.s == b.s && a.rho < b.rho); });
  // Upper convex hull of the corners.
  std::vector<ProfilePoint> hull;
  for (const ProfilePoint& p : corners) {
    // Keep the widest point at each s.
    while (!hull.empty() && hull.back().s == p.s) hull.pop_back();
    while (hull.size() >= 2 && cross(hull[hull.size() - 2], hull.back(), p) >= 0.0) hull.pop_back();
    hull.push_back(p);
  }
  // Move the tip centre of the hull to s = 0.
  const double forward = hull.back().s;
  for (ProfilePoint& p : hull) p.s -= forward;
  return {std::make_unique<Revolved>(std::move(hull), round ? Tip::round : Tip::flat), forward};
}

BurProfile bur_profile(BurFamily family, double diameter, double length, double shank_diameter) {
  const auto needs_length = [](const char* what, double value) {
    if (!(value > 0.0 && std::isfinite(value))) refuse_length(what, value, "more than", 0.0);
  };
  needs_length("the diameter of a bur", diameter);
  needs_length("the length of a bur", length);
  needs_length("the shank diameter of a bur", shank_diameter);
  const double radius = 0.5 * diameter, shank = 0.5 * shank_diameter;
  const bool swells = family == BurFamily::ball || family == BurFamily::pear || family == BurFamily::flame;
  if (swells && shank >= radius) {
    refuse_length("the shank diameter of a ball, pear or flame bur", shank_diameter, "less than its head's,", diameter);
  }
  switch (family) {
    case BurFamily::ball:
      if (std::abs(length - diameter) > 1e-9 * diameter)
        refuse_length("the length of a ball bur", length, "its diameter,", diameter);
      return ball(radius, shank);
    case BurFamily::cylinder:
      return frustum(-length, radius, radius, shank, Tip::flat);
    case BurFamily::tapered:
      return frustum(-length, radius, kNarrowEnd * radius, shank, Tip::flat);
    case BurFamily::inverted_cone:
      return frustum(-length, kNarrowEnd * radius, radius, shank, Tip::flat);
    case BurFamily::round_cylinder:
      if (length < radius)
        refuse_length("the length of a round cylinder bur", length, "at least half its diameter,", radius);
      return frustum(radius - length, radius, radius, shank, Tip::round);
    case BurFamily::pear:
      return pear(radius, length, shank);
    case BurFamily::flame:
      break;
  }
  return flame(radius, length, shank);
}

}  // namespace hapbench
