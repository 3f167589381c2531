#pragma once

#include <span>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// A drill's stylus: a cylinder with a flat or a round tip (thesis sections A.1.1 and B.1).
///
///      <----------- length L ----------->
///     +----------------------------------+           s = <x - position, axis> along the axis:
///     |  bottom, s = -L                  p --> axis  the body has -L <= s <= 0 and radial distance <= radius
///     +----------------------------------+
///
/// Contact search and depths use the axial coordinates of sim/tool/axial.hpp. A rotation about the axis changes
/// nothing.
class Cylinder final : public ToolShape {
 public:
  /// Radius and length in m, both > 0. The length is measured from the bottom to the tip plane s = 0 and does not
  /// include the half ball of a round tip.
  Cylinder(double radius = 0.0005, double length = 0.01, Tip tip = Tip::flat);

  double radius() const noexcept { return radius_; }
  double length() const noexcept { return length_; }
  Tip tip() const noexcept { return tip_; }
  /// Upper bound of exit_distances() [m].
  double max_exit_distance() const noexcept { return length_ + 3.0 * radius_; }

  bool convex() const noexcept override { return true; }
  bool is_axisymmetric() const noexcept override { return true; }
  std::vector<ProfilePoint> outline() const override;
  void push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                   ContactBuffer& contacts) const noexcept override;
  /// Marks the points in the cylinder that is enlarged by the margin. At the edges of a flat tip and of the bottom,
  /// marked points may be up to sqrt(2) times the margin away from the tool.
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  /// Returns a row of balls along the axis.
  Cover cover(double margin) const override;
  /// Depth d = min(r - |rho|, -s, L + s), with gradient u = rho / |rho|, axis or -axis for the smallest term
  /// (thesis section B.1). r: radius; rho: radial vector. With a round tip, d = r - |x| and u = x / |x| for s > 0,
  /// where x is the position relative to the tip centre.
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  /// If several surfaces are equally near, prefers the side, then the tip, then the bottom.
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  /// If several surfaces are equally near, prefers the side, then the tip, then the bottom.
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  void support_points(const ToolPose& pose, const ContactBuffer& contacts,
                      const MutablePointArrays& surface_points) const noexcept override;
  /// The grown cylinder extends beyond a flat tip by `margin`, so its tip centre lies `margin` ahead of the tip centre
  /// of this cylinder.
  Grown grown(double margin) const override;

 private:
  double radius_;
  double length_;
  Tip tip_;
  double radius2_;  ///< largest_square_within(radius) [m^2]
};

/// Returns the largest double whose square root does not exceed r. The contact search compares squared distances with
/// this number and needs no square roots. For every point on the surface, the comparison agrees with the depth
/// functions, which use the square root.
double largest_square_within(double r);

}  // namespace hapbench
