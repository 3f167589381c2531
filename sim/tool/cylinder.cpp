#include "sim/tool/cylinder.hpp"

#include <cmath>
#include <limits>

#include "sim/tool/axial_search.hpp"

namespace hapbench {

double largest_square_within(double r) {
  constexpr double up = std::numeric_limits<double>::infinity();
  double square = r * r;
  while (std::sqrt(square) > r) square = std::nextafter(square, 0.0);
  while (std::sqrt(std::nextafter(square, up)) <= r) square = std::nextafter(square, up);
  return square;
}

Cylinder::Cylinder(double radius, double length, Tip tip)
    : ToolShape(radius, std::hypot(length, radius)),
      radius_(radius),
      length_(length),
      tip_(tip),
      radius2_(largest_square_within(radius)) {}

std::vector<ProfilePoint> Cylinder::outline() const {
  std::vector<ProfilePoint> outline = {{-length_, 0.0}, {-length_, radius_}, {0.0, radius_}};
  if (tip_ == Tip::flat) {
    outline.push_back({0.0, 0.0});
  } else {
    add_round_tip(radius_, outline);
  }
  return outline;
}

/// Calls `use` with the test of a pack of points for the body.
template <class Use>
void Cylinder::with_test(const Use& use) const {
  const simd::Pack bottom(-length_), radius2(radius2_), zero(0.0);
  const auto in_cylinder = [=](const AxialPack& q) { return q.s <= zero && q.s >= bottom && q.rho2 <= radius2; };
  if (tip_ == Tip::flat) return use(in_cylinder);
  use([=](const AxialPack& q) { return in_cylinder(q) || (q.s > zero && q.distance2() <= radius2); });
}

void Cylinder::mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                           std::uint8_t* marks) const noexcept {
  with_test([&](const auto& test) { mark(pose, points, ranges, marks, test); });
}

void Cylinder::push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                           ContactBuffer& contacts) const noexcept {
  with_test([&](const auto& test) { push(pose, points, ranges, contacts, test); });
}

void Cylinder::mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept {
  const double radius = radius_ + margin;
  const simd::Pack radius2(radius * radius), low(-length_ - margin), high(tip_ == Tip::round ? radius : margin);
  mark(pose, points, ranges, marks, [&](const AxialPack& q) { return q.s <= high && q.s >= low && q.rho2 <= radius2; });
}

Box Cylinder::box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept {
  const double radius = radius_ + margin;
  const AxisPart whole{-(length_ + margin), tip_ == Tip::round ? radius : margin};
  const AxisPart part = part_near(whole, pose, radius, bounds);
  return box_around(part, pose, radius);
}

ToolShape::Cover Cylinder::cover(double margin) const {
  const double radius = radius_ + margin;
  return row_of_balls(radius, length_ + margin + (tip_ == Tip::round ? radius : margin));
}

double Cylinder::moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept {
  return axis_moved_at_most(from, to, reach());
}

ToolShape::Grown Cylinder::grown(double margin) const {
  const bool flat = tip_ == Tip::flat;  // a round tip grows with the radius
  const double ends = flat ? 2.0 * margin : margin;
  return {std::make_unique<Cylinder>(radius_ + margin, length_ + ends, tip_), flat ? margin : 0.0};
}

}  // namespace hapbench
