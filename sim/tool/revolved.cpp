#include "sim/tool/revolved.hpp"

#include <algorithm>
#include <cmath>

#include "sim/tool/axial_search.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/revolved_body.hpp"

/// What a contact search asks of a solid of revolution.
namespace hapbench {

using simd::Mask, simd::Pack;

Revolved::Revolved(std::vector<ProfilePoint> profile, Tip tip) : Revolved(Meridian(std::move(profile), tip)) {}

Revolved::Revolved(Meridian meridian)
    : ToolShape(meridian.widest, meridian.reach),
      meridian_(std::move(meridian)),
      widest2_(largest_square_within(meridian_.widest)),
      ball2_(largest_square_within(meridian_.ball)) {}

/// Calls `use` with the test of a pack of points for the body.
template <class Use>
void Revolved::with_test(const Use& use) const {
  const Pack low(meridian_.low), high(meridian_.high), widest2(widest2_), ball2(ball2_), zero(0.0);
  const auto in_profile = [=, this](const AxialPack& q) {
    const Mask around = q.s >= low && q.s <= high && q.rho2 <= widest2;
    return simd::any(around) ? in_section(meridian_, around, q.s, q.rho2) : around;
  };
  if (meridian_.tip == Tip::flat) return use(in_profile);
  use([=](const AxialPack& q) { return in_profile(q) || (q.s > zero && q.distance2() <= ball2); });
}

void Revolved::mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                           std::uint8_t* marks) const noexcept {
  with_test([&](const auto& test) { mark(pose, points, ranges, marks, test); });
}

void Revolved::push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                           ContactBuffer& contacts) const noexcept {
  with_test([&](const auto& test) { push(pose, points, ranges, contacts, test); });
}

void Revolved::mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept {
  const Meridian& m = meridian_;
  const bool round = m.tip == Tip::round;
  const Pack low(m.low - margin), high(std::max(m.high, m.ball) + margin), zero(0.0), within(margin);
  const Pack widest2((m.widest + margin) * (m.widest + margin)), ball2((m.ball + margin) * (m.ball + margin));
  mark(pose, points, ranges, marks, [&, round](const AxialPack& q) {
    const Mask around = q.s >= low && q.s <= high && q.rho2 <= widest2;
    if (!simd::any(around)) return around;
    const Pack rho = simd::sqrt(q.rho2);
    const Mask near_profile = m.convex ? convex_depth(m, q.s, rho) >= -within
                                       : in_section(m, around, q.s, q.rho2) || nearest_distance(m, q.s, rho) <= within;
    return round ? around && (near_profile || (q.s > zero && q.distance2() <= ball2)) : around && near_profile;
  });
}

Box Revolved::box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept {
  const AxisPart whole{meridian_.low - margin, std::max(meridian_.high, meridian_.ball) + margin};
  const AxisPart part = part_near(whole, pose, meridian_.widest + margin, bounds);
  // Points in `bounds` have their s in the part, and the places of the body near them theirs within the margin.
  double widest = part.high + margin >= 0.0 ? meridian_.ball : 0.0;
  for (std::size_t i = 0; i + 1 < meridian_.profile.size(); ++i) {
    const auto [a, b] = std::pair(meridian_.profile[i], meridian_.profile[i + 1]);
    const bool beside = std::max(a.s, b.s) >= part.low - margin && std::min(a.s, b.s) <= part.high + margin;
    if (beside) widest = std::max({widest, a.rho, b.rho});
  }
  return box_around(part, pose, widest + margin);
}

ToolShape::Cover Revolved::cover(double margin) const {
  const double length = std::max(meridian_.high, meridian_.ball) - meridian_.low + 2.0 * margin;
  return row_of_balls(meridian_.widest + margin, length);
}

double Revolved::moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept {
  return axis_moved_at_most(from, to, reach());
}

std::vector<ProfilePoint> Revolved::outline() const {
  std::vector<ProfilePoint> outline = profile();
  if (outline.front().rho > 0.0) outline.insert(outline.begin(), {outline.front().s, 0.0});
  if (tip() == Tip::round) {
    add_round_tip(outline.back().rho, outline);
  } else if (outline.back().rho > 0.0) {
    outline.push_back({outline.back().s, 0.0});
  }
  return outline;
}

ToolShape::Grown Revolved::grown(double margin) const {
  GrownProfile grown = grown_profile(meridian_, margin);
  const double forward = grown.points.back().s;
  for (ProfilePoint& p : grown.points) p.s -= forward;
  return {std::make_unique<Revolved>(std::move(grown.points), grown.tip), forward};
}

}  // namespace hapbench
