#include "sim/tool/meridian.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "sim/core/math.hpp"
#include "sim/tool/refuse.hpp"

namespace hapbench {
namespace {

/// Sine of the largest angle by which a corner may turn inwards and still count as straight.
constexpr double kStraight = 1e-12;

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
  const auto have_opposite_signs = [](double x, double y) { return (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0); };
  if (have_opposite_signs(abc, abd) && have_opposite_signs(cda, cdb)) return true;
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
      refuse(last, "a round tip is half a ball about the tip centre, so the profile must end at s = 0 with rho > 0");
    }
    if (!(points_[0].s < points_[last].s)) {
      refuse(last, "a profile runs from the shank's end to the tip, so its last s must be larger than its first");
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
    if (!std::isfinite(p.s) || !std::isfinite(p.rho)) refuse(i, "both numbers must be finite");
    if (p.s > 0.0) refuse(i, "s must be <= 0: the tip centre has s = 0, and the shank lies behind it");
    if (p.rho < 0.0) refuse(i, "rho, the distance from the axis, must be >= 0");
    if (i > 0 && p.rho == 0.0 && points_[i - 1].rho == 0.0)
      refuse(i, "on the axis, like the previous point: there is no body between the two points");
    const bool inner = i > 0 && i + 1 < points_.size();
    if (inner && p.rho == 0.0) refuse(i, "only the first and the last point may lie on the axis");
    if (i > 0 && p == points_[i - 1]) refuse(i, "equal to the previous point");
  }

  /// Returns the segments of the closed outline.
  std::vector<Edge> edges() const {
    const auto n = static_cast<std::ptrdiff_t>(points_.size());
    std::vector<Edge> all;
    if (points_.front().rho > 0.0) all.push_back({-1, 0});
    for (std::ptrdiff_t i = 0; i + 1 < n; ++i) all.push_back({i, i + 1});
    // The half ball of a round tip may be wider than the body behind it. The disc that closes the tip then begins
    // at the previous corner.
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
        refuse(static_cast<std::size_t>(all[k].to), "here the profile reverses onto itself");
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

/// Divides the part s <= 0 of the section that a meridian encloses into convex parts. The half ball of a round tip
/// (s > 0) is not divided.
class SectionParts {
 public:
  /// Convex part under construction.
  struct Part {
    double low, high;                  ///< range of s [m]
    std::optional<std::size_t> below;  ///< lower line of the part; empty if the part reaches the axis
    std::vector<std::size_t> above;    ///< upper lines of the part, in order
  };

  explicit SectionParts(const Meridian& meridian) : profile_(meridian.profile), lines_(meridian.lines) {}

  /// Returns the convex parts. First cuts the section into trapezoids between consecutive values of s at the corners.
  /// Then joins a trapezoid to the part that ends where the trapezoid begins, if both have the same lower line and the
  /// upper line of the trapezoid continues the part's upper line without turning inwards.
  std::vector<Part> cut() {
    const std::vector<double> levels = corner_levels();
    for (std::size_t k = 0; k + 1 < levels.size(); ++k) add_trapezoids(levels[k], levels[k + 1]);
    return std::move(parts_);
  }

 private:
  /// Returns the values of s at which trapezoids begin and end, in increasing order.
  std::vector<double> corner_levels() const {
    std::vector<double> levels;
    for (const ProfilePoint& p : profile_) levels.push_back(p.s);
    std::sort(levels.begin(), levels.end());
    levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
    return levels;
  }

  /// Returns the lines of the profile across the interval `from` <= s <= `to`, from the axis outwards.
  std::vector<std::size_t> lines_across(double from, double to) const {
    std::vector<std::size_t> across;
    for (std::size_t i = 0; i + 1 < profile_.size(); ++i) {
      const auto [lower, upper] = std::minmax(profile_[i].s, profile_[i + 1].s);
      if (lower <= from && upper >= to) across.push_back(i);
    }
    const double middle = 0.5 * (from + to);
    std::ranges::sort(across, {}, [&](std::size_t i) { return height(i, middle); });
    return across;
  }

  /// Adds the trapezoids between two consecutive levels: pairs each upper line with the lower line below it, or with
  /// the axis.
  void add_trapezoids(double from, double to) {
    std::optional<std::size_t> below;
    for (const std::size_t i : lines_across(from, to)) {
      const bool is_lower = lines_[i].nr < 0.0;
      if (is_lower) {
        below = i;
      } else {
        add_trapezoid(from, to, below, i);
        below.reset();
      }
    }
  }

  /// Joins a trapezoid to a part, or begins a new part.
  void add_trapezoid(double from, double to, const std::optional<std::size_t>& below, std::size_t above) {
    const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) {
      return p.high == from && p.below == below && goes_on(p.above.back(), above);
    });
    if (part == parts_.end()) {
      parts_.push_back({from, to, below, {above}});
      return;
    }
    part->high = to;
    if (part->above.back() != above) part->above.push_back(above);
  }

  /// Returns true if `to` and `from` are the same line, or if line `to` follows line `from` without turning inwards.
  bool goes_on(std::size_t from, std::size_t to) const {
    return from == to ||
           (to == from + 1 && lines_[from].ns * lines_[to].nr - lines_[from].nr * lines_[to].ns <= kStraight);
  }

  double height(std::size_t i, double s) const { return (lines_[i].offset - lines_[i].ns * s) / lines_[i].nr; }

  const std::vector<ProfilePoint>& profile_;
  const std::vector<Meridian::Line>& lines_;
  std::vector<Part> parts_;
};

}  // namespace

double cross(const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c) {
  return (b.s - a.s) * (c.rho - a.rho) - (b.rho - a.rho) * (c.s - a.s);
}

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

void Meridian::add_parts() {
  // Divide the section, and store the lines of the parts.
  const auto add_height = [this](std::size_t i) {
    const ProfilePoint a = profile[i], b = profile[i + 1];
    const double slope = (b.rho - a.rho) / (b.s - a.s);
    heights.push_back({a.rho - slope * a.s, slope});
  };
  const std::vector<SectionParts::Part> cut = SectionParts(*this).cut();
  for (const SectionParts::Part& part : cut) {
    const std::size_t first = heights.size();
    for (const std::size_t i : part.above) add_height(i);
    if (part.below) add_height(*part.below);
    parts.push_back({part.low, part.high, first, heights.size(), part.below.has_value()});
  }

  // The body is convex if its section is one part that reaches the axis. If the tip is round, the outline also must not
  // turn inwards where the half ball begins.
  const Line& last = lines[profile.size() - 2];
  convex = cut.size() == 1 && !cut[0].below && (tip == Tip::flat || (last.nr > 0.0 && last.ns <= kStraight));
  if (!convex) return;
  for (const std::size_t i : cut[0].above) planes.push_back(lines[i]);
}

}  // namespace hapbench
