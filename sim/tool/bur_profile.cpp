#include "sim/tool/bur_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/core/math.hpp"
#include "sim/tool/refuse.hpp"

namespace hapbench {
namespace {

constexpr double kSagittaPerDiameter = 1e-3;
constexpr double kShankPerDiameter = 10.0;
constexpr double kNarrowEnd = 0.6;  ///< diameter of the narrow end of a cone frustum, relative to the wide end
constexpr double kRearOfFlame = 1.0 / 3.0;

[[noreturn]] void refuse_length(const char* what, double is, const char* has_to, double bound) {
  refuse(what, " is ", is, " m and must be ", has_to, ' ', bound, " m");
}

/// Profile under construction, from the shank's end to the tip.
class Outline {
 public:
  Outline(double diameter, double shank_radius, double head_begins) : sagitta_(kSagittaPerDiameter * diameter) {
    points_ = {{head_begins - 2.0 * kShankPerDiameter * shank_radius, shank_radius}, {head_begins, shank_radius}};
  }

  /// Adds a segment from the profile's end to the point (s, rho), unless the profile already ends at this point.
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

constexpr double kAbreast = 0.5 * std::numbers::pi;  ///< angle of a circle's point farthest from the axis [rad]

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

/// Returns a ball about the tip centre and a cone that widens from the shank at (begins, neck) and touches the ball.
/// The cone touches the ball at the angle `touches` from the axis: the cone's unit normal
/// n = (cos touches, sin touches) satisfies <n, (begins, neck)> = radius.
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

/// Returns two arcs: from the shank to the largest radius, and from there to the pointed tip. An arc that is parallel
/// to the axis at its highest point and falls by h over the length l has the radius (l^2 + h^2) / (2 h).
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
