#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/types.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// Points as one array per coordinate, aligned and padded to whole packs of eight (sim/core/simd.hpp), and the same for
/// output.
struct PointArrays {
  const double *x, *y, *z;
};
struct PlaceArrays {
  double *x, *y, *z;
};

/// A run of points in such arrays: packs first … last - 1, without some points of the first and the last one.
struct PackRange {
  std::size_t first, last;
  std::uint8_t own_in_first = 0xff;  ///< bit k: point k of the first pack belongs to the run
  std::uint8_t own_in_last = 0xff;   ///< the same for the last pack

  /// Clears the marks of a pack's points that do not belong to the run.
  std::uint8_t own(std::uint8_t marks, std::size_t pack) const noexcept {
    if (pack == first) marks &= own_in_first;
    if (pack + 1 == last) marks &= own_in_last;
    return marks;
  }
};

/// Cosine of the angle, 6 degrees, up to which a flat face of a tool counts as flush with a surface: normals of shells
/// are off by a few degrees, and a face that leans by more would hold an edge up too early.
inline constexpr double kFlush = 0.9945;

/// The solid that touches the environment: the geometry that contact search, depth models, the proxy and metrics need.
/// Code outside the shapes uses this interface alone and knows neither a radius nor a tip.
///
/// Poses and points are given in the world frame, lengths in metres. The pose's position is the tip centre. A shape
/// that is not a solid of revolution uses the pose's rotation().
///
/// Each call handles many points, so that its virtual dispatch is paid once per query or step. All functions except
/// `outline`, `grown` and `cover` are called in the step loop and allocate nothing. Shapes are immutable and may be
/// shared between runs and threads.
///
/// Search and depths must agree about points on the surface: a point that `push_inside` finds has a depth >=
/// 0 up to rounding, so both should use the same operations in the same order.
class ToolShape {
 public:
  virtual ~ToolShape() = default;

  /// Half the thickness of the body [m]; skins and margins are multiples of it.
  double half_width() const noexcept { return half_width_; }
  /// Distance of the body's furthest point from the tip centre.
  double reach() const noexcept { return reach_; }
  /// Largest distance of the body's surface from the one that it stands for [m], such as a mesh sampled on a grid.
  virtual double surface_error() const noexcept { return 0.0; }
  /// A proxy keeps every point out of a convex body only.
  virtual bool convex() const noexcept = 0;
  /// True for a solid of revolution about the axis: a turn about the axis maps the body to itself, so that no answer of
  /// the shape depends on the roll of a pose.
  virtual bool is_axisymmetric() const noexcept = 0;
  /// The outline for drawings, in the axial half plane: from the far end on the axis to the foremost point on the axis,
  /// curves as polylines. For a body that is not a solid of revolution it is the largest rho at each s. Allocates.
  virtual std::vector<ProfilePoint> outline() const = 0;

  // Contact search.

  /// Appends the points of the first `packs` packs that lie in the body or on its surface, in order; none for a pose
  /// that is not finite. Precondition: `contacts` has room.
  virtual void push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                           ContactBuffer& contacts) const noexcept = 0;
  /// Marks every point of the ranges within `margin` >= 0 of the body, and possibly some a little further away: bit k
  /// of a mark stands for point k of a pack. Writes a mark for each pack of the ranges, range after range.
  virtual void mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept = 0;
  /// A box that contains every point of `bounds` within `margin` of the body, ideally around the part of the body near
  /// `bounds` alone. Empty if no part is near.
  virtual Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept = 0;
  /// Number and radius [m] of balls that together contain the body and everything that `mark_near` marks with this
  /// margin. Many small balls bound the number of points that the body can touch (most_points_in, grid_index.hpp) more
  /// tightly than the one ball of this default, which suits a `mark_near` that reaches at most twice the margin.
  struct Cover {
    std::size_t balls;
    double radius;
  };
  virtual Cover cover(double margin) const { return {1, (1.0 + 1e-9) * (reach_ + 2.0 * margin)}; }
  /// Upper bound of the distance by which a move from one pose to the other moves any point of the body [m]. This
  /// default is that of a solid of revolution: the shortest rotation from one axis to the other moves a point by at
  /// most |a' - a| times its distance from the tip centre; a turn about the axis maps the body to itself.
  virtual double moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept {
    const double moved = (to.position - from.position).norm();
    // Most steps of most scenes do not turn the tool; adding a turn of zero would change no bit.
    if (to.axis == from.axis) return moved;
    return moved + (to.axis - from.axis).norm() * reach_;
  }

  // Depth models. Precondition: the contacts lie in the body or on its surface.

  /// Writes each contact's distance to the nearest place of the surface as its depth. May write the whole last pack, as
  /// the following.
  virtual void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept = 0;
  /// Writes the unit vector to that place as each contact's gradient; the contact's inverse normal if no single place
  /// is nearest, as on a cylinder's axis.
  virtual void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept = 0;
  /// Writes to exits[i], i < size(), the distance from contact i to where the ray along its gradient leaves the body.
  /// Finite and >= 0, also for points on the surface.
  virtual void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept = 0;

  // The proxy. Its guarantee holds for a convex body; a shape that is not convex documents what it returns instead.

  /// Constraints that keep the body out of points near it: for each contact the signed distance g_i of the point to the
  /// body's surface, negative inside, as depth d_i = -g_i, and the outward normal at the nearest place of the surface
  /// as gradient m_i. Pads.
  ///
  /// The signed distance to a convex body is a convex function of the point and m_i one of its subgradients. Moved by
  /// x, the body is at least g_i - <m_i, x> away from the point, hence
  ///
  ///     d_i + <m_i, x> <= 0   =>   the point is not inside the moved body,
  ///
  /// for moves of any length. If the nearest place is not unique, any of the nearest ones has that property.
  ///
  /// A flat face that slides along a surface would bump into the points ahead, which lie in its plane and whose nearest
  /// place is its edge. Either face of an edge keeps out a point beyond (or within `slack` of) both faces. Therefore,
  /// if the move `wanted` violates the nearest one, a face that is flush with the contact's normal replaces it.
  virtual void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                                   ContactBuffer& contacts) const noexcept = 0;
  /// Writes the place of the body that is foremost against each contact's normal: the support point in the direction
  /// -n_i, argmin <q, n_i> over the body. If there are several, the one abreast of the contact.
  virtual void foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                               const PlaceArrays& places) const noexcept = 0;

  /// The body grown on all sides; its tip centre lies `forward` [m] ahead along the axis.
  struct Grown {
    std::unique_ptr<const ToolShape> shape;
    double forward;
  };
  /// A shape that contains every point within `margin` >= 0 of this one, and possibly a little more. Allocates.
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
