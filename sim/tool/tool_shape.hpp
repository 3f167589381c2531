#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/box.hpp"
#include "sim/tool/profile_point.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// Points as arrays of one coordinate each, aligned and padded to whole packs of eight (sim/core/simd.hpp).
struct PointArrays {
  const double *x, *y, *z;
};

/// The same to write to.
struct PlaceArrays {
  double *x, *y, *z;
};

/// A run of points in such arrays: packs first … last - 1, of the first and the last of which it may own but some
/// points.
struct PackRange {
  std::size_t first, last;
  std::uint8_t own_in_first = 0xff;  ///< bit k: point k of the first pack belongs to the run
  std::uint8_t own_in_last = 0xff;   ///< the same of the last pack

  /// Those of the marks of a pack that are about the run's own points.
  std::uint8_t own(std::uint8_t marks, std::size_t pack) const noexcept {
    if (pack == first) marks &= own_in_first;
    if (pack + 1 == last) marks &= own_in_last;
    return marks;
  }
};

/// Cosine of the angle up to which a flat face of a tool counts as flush with a surface, 6 degrees: normals of shells are
/// off by a few, and a face that leans by more holds an edge up too early.
inline constexpr double kFlush = 0.9945;

/// The solid that touches the environment: everything that contact search, depth models, the proxy and metrics ask of
/// its geometry. What lies beyond this interface knows neither a radius nor a tip. A new shape is a class derived from
/// this one, a line in sim/CMakeLists.txt and the place where a scenario's tool is made; sim/tool/cylinder.hpp is the
/// model to follow.
///
/// Frames and units. Poses and points are given in the world frame, lengths in metres. The pose's position is the tip
/// centre. A shape that is no solid of revolution reads the pose's rotation().
///
/// Cost. Each call answers for many points, so that its virtual dispatch is paid once for a query or a step and never
/// for a point. All of them but `outline`, `grown` and `cover` are called in the step loop and allocate nothing. Shapes
/// are immutable, and may be shared between runs and threads.
///
/// Rounding. Search and depths must agree about points on the surface: a point that `mark_inside` marks has a depth >=
/// 0 up to rounding, so both should compute with the same operations in the same order.
class ToolShape {
 public:
  virtual ~ToolShape() = default;

  /// The unit of skins and margins: half of how thick the body is.
  double half_width() const noexcept { return half_width_; }
  /// Distance of the body's furthest point from the tip centre.
  double reach() const noexcept { return reach_; }
  /// Whether the body holds the straight line between any two of its points. A proxy keeps every point out of a convex
  /// body only.
  virtual bool convex() const noexcept = 0;
  /// What drawings show of the body: its outline in the axial half plane, from the far end on the axis to the foremost
  /// point on the axis, curves as polylines. Of a body that is no solid of revolution the silhouette: the largest rho
  /// over s. Allocates.
  virtual std::vector<ProfilePoint> outline() const = 0;

  // Contact search.

  /// Tells which points of the ranges lie in the body or on its surface: bit k of a mark says so of point k of a pack.
  /// Writes a mark for each pack of the ranges, one range after the other. Marks of a pose that is not finite are zero.
  virtual void mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                           std::uint8_t* marks) const noexcept = 0;
  /// Appends the points that `mark_inside` would mark, in their order: in one pass, since this is what most steps ask.
  /// Precondition: `contacts` has room.
  virtual void push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                           ContactBuffer& contacts) const noexcept = 0;
  /// Marks every point of the ranges within `margin` >= 0 of the body, and perhaps some a little further away.
  virtual void mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept = 0;
  /// A box that holds every point of `bounds` that lies within `margin` of the body: best the box around the part of it
  /// that is near `bounds`, since most of a tool sticks out of what it works on. Empty when no part is near.
  virtual Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept = 0;
  /// Balls that together hold the body and what `mark_near` marks with this margin: how many, of which radius [m]. Many
  /// small ones bound the number of points that the body can touch (sim/contact/most_points.hpp) tighter than the
  /// one given here, which suits a `mark_near` that reaches no further than twice the margin.
  struct Cover {
    std::size_t balls;
    double radius;
  };
  virtual Cover cover(double margin) const { return {1, (1.0 + 1e-9) * (reach_ + 2.0 * margin)}; }
  /// No point of the body has moved further than this when the tool has gone from one pose to the other.
  virtual double moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept = 0;

  // Depth models. The contacts are points in the body (closed set).

  /// Writes how far each contact lies from the nearest place of the surface as its depth. Touches nothing else, and may
  /// write the whole last pack.
  virtual void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept = 0;
  /// Writes the unit vector to that nearest place as each contact's gradient; the contact's inverse normal where no
  /// place is nearest, as on a cylinder's axis. May write the whole last pack.
  virtual void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept = 0;
  /// Writes to exits[i] how far contact i lies from where the ray along its gradient leaves the body, for i < size().
  /// Finite and >= 0, for points on the surface too.
  virtual void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept = 0;

  // The proxy. Its guarantee is for a convex body; a shape that is not says what it answers instead.

  /// What keeps the body out of points near it: for each contact the signed distance g_i of the point to the body's
  /// surface, negative inside, as depth d_i = -g_i, and the outward normal at the nearest place of the surface as
  /// gradient m_i. Pads.
  ///
  /// The signed distance to a convex body is a convex function of the point and m_i one of its subgradients. Moved by
  /// x, the body is at least g_i - <m_i, x> away from the point, hence
  ///
  ///     d_i + <m_i, x> <= 0   =>   the point is not inside the moved body,
  ///
  /// for moves of any length. Where the nearest place is not unique, any of the nearest ones has that property.
  ///
  /// A flat face that slides along a surface would bump into the points ahead: they lie in its plane, and the nearest
  /// place of the body is its edge. A point beyond (or within `slack` of) both faces of an edge is kept out by either,
  /// so when the move `wanted` violates the nearest one, the face that is flush with the contact's normal takes its
  /// place, if one is.
  virtual void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                                   ContactBuffer& contacts) const noexcept = 0;
  /// Writes the place of the body that is foremost against the normal of each contact, argmin <q, n_i> over the body:
  /// its support point in direction -n_i. Where there are several, the one abreast of the contact. May write the whole
  /// last pack.
  virtual void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                               const PlaceArrays& places) const noexcept = 0;

  /// The body grown on all sides, at a pose whose position lies `forward` ahead along the axis.
  struct Grown {
    std::unique_ptr<const ToolShape> shape;
    double forward;
  };
  /// A shape that holds every point within `margin` >= 0 of this one, and perhaps some a little further away.
  /// Allocates.
  virtual Grown grown(double margin) const = 0;

 protected:
  ToolShape(double half_width, double reach) : half_width_(half_width), reach_(reach) {}
  ToolShape(const ToolShape&) = default;
  ToolShape& operator=(const ToolShape&) = default;

 private:
  double half_width_;
  double reach_;
};

}  // namespace hapbench
