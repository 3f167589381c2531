#pragma once

#include "sim/tool/tool_shape.hpp"

namespace hapbench::test {

/// A tool shape made by the documentation of ToolShape alone, in plain loops: a brick with its tip centre in the middle
/// of one face. It is no solid of revolution, so it also tells whether a pose's roll arrives.
class Brick final : public ToolShape {
 public:
  /// Half extents across the axis and the length along it [m].
  Brick(double half_x, double half_y, double length);

  /// How far the point lies inside, by the nearest of the six faces [m]; negative outside.
  double slack(const ToolPose& pose, const Vec3& point) const;

  bool convex() const noexcept override { return true; }
  std::vector<ProfilePoint> outline() const override;
  void push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                   ContactBuffer& contacts) const noexcept override;
  void mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                   std::uint8_t* marks) const noexcept override;
  void mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                 std::uint8_t* marks) const noexcept override;
  Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept override;
  double moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept override;
  void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept override;
  void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept override;
  void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                           ContactBuffer& contacts) const noexcept override;
  void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                       const PlaceArrays& places) const noexcept override;
  Grown grown(double margin) const override;

 private:
  Vec3 low_, high_;  ///< corners in the tool's frame, whose axis is -z
};

}  // namespace hapbench::test
