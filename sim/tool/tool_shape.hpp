#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/types.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// Points as one array per coordinate [m], aligned and padded to whole packs of eight (sim/core/simd.hpp).
struct PointArrays {
  const double *x, *y, *z;
};
/// Output arrays for points in the layout of PointArrays.
struct MutablePointArrays {
  double *x, *y, *z;
};

/// Range of points in PointArrays: the packs first … last - 1. Some points of the first and the last pack may be
/// excluded.
struct PackRange {
  std::size_t first, last;
  std::uint8_t mask_of_first = 0xff;  ///< bit k: point k of the first pack belongs to the range
  std::uint8_t mask_of_last = 0xff;   ///< bit k: point k of the last pack belongs to the range

  /// Returns `marks` (bit k: point k) of pack number `pack`, with the bits of all points outside of the range
  /// cleared.
  std::uint8_t own(std::uint8_t marks, std::size_t pack) const noexcept {
    if (pack == first) marks &= mask_of_first;
    if (pack + 1 == last) marks &= mask_of_last;
    return marks;
  }
};

/// Cosine of the largest angle, 6 degrees, between a tool's flat face and a surface at which the face counts as flush
/// with the surface. The normals of shells are wrong by a few degrees. If faces at larger angles counted as flush, the
/// proxy would stop too early, with the edge of the face still above the surface.
inline constexpr double kFlush = 0.9945;

/// Shape of the tool: the geometry that contact search, depth models, the proxy and metrics need. Code outside of the
/// shapes uses only this interface and does not depend on a radius or a type of tip.
///
/// Poses and points are in the world frame, lengths in m. The position of a pose is the tip centre. A shape that is
/// not a solid of revolution uses the pose's rotation().
///
/// Each call processes many points, so the cost of its virtual dispatch is paid once per query or step. All
/// functions except `outline`, `grown` and `cover` are called in the step loop and allocate nothing. Shapes are
/// immutable and may be shared between runs and threads.
///
/// Contact search and depths must agree about points on the surface: a point found by `push_inside` must have a
/// depth >= 0 up to rounding. Both should therefore use the same operations in the same order.
class ToolShape {
 public:
  virtual ~ToolShape() = default;

  /// Half the thickness of the body [m]; skins and margins of the contact search are multiples of it.
  double half_width() const noexcept { return half_width_; }
  /// Distance from the tip centre to the farthest point of the body [m].
  double reach() const noexcept { return reach_; }
  /// Largest distance [m] between the surface of the body and the exact surface that it approximates, such as a
  /// mesh sampled on a grid; 0 if the body is exact.
  virtual double surface_error() const noexcept { return 0.0; }
  /// Returns true if the body is convex. Only for a convex body does the proxy keep every point outside of the body.
  virtual bool convex() const noexcept = 0;
  /// Returns true for a solid of revolution about the axis. A rotation about the axis maps such a body to itself,
  /// so no result depends on the roll of a pose.
  virtual bool is_axisymmetric() const noexcept = 0;
  /// Returns the outline for drawings, in the axial half plane: a polyline from the rear end on the axis to the front
  /// end on the axis. For a body that is not a solid of revolution, rho at each s is the largest distance of the body
  /// from the axis (ProfilePoint). Allocates.
  virtual std::vector<ProfilePoint> outline() const = 0;

  // Contact search.

  /// Looks at the first `packs` packs of `points`. Appends those of their points that lie in the body or on its surface
  /// to `contacts`, in the order of `points`. Appends nothing if the pose is not finite. Precondition: `contacts` has
  /// room for the appended points.
  virtual void push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                           ContactBuffer& contacts) const noexcept = 0;
  /// Marks every point of the ranges within `margin` [m] of the body, and possibly some points slightly farther
  /// away. Writes one byte for each pack of the ranges, range after range; bit k stands for point k of the pack.
  /// Precondition: margin >= 0.
  virtual void mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept = 0;
  /// Returns a box that contains every point of `bounds` within `margin` [m] of the body. Ideally the box encloses only
  /// the part of the body near `bounds`. The box is empty if no part of the body is near `bounds`.
  virtual Box box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept = 0;
  /// Number and radius [m] of balls. For the margin given to `cover`, the union of the balls contains the body and
  /// every point that `mark_near` marks with this margin. Used to bound the number of points that the body can touch
  /// (max_points_in, neighbour_list_query.hpp); many small balls give a tighter bound than one ball. The default is one
  /// ball, which is valid if `mark_near` marks no point farther away from the body than twice the margin.
  struct Cover {
    std::size_t balls;
    double radius;
  };
  virtual Cover cover(double margin) const { return {1, (1.0 + 1e-9) * (reach_ + 2.0 * margin)}; }
  /// Returns an upper bound [m] of the distance by which any point of the body moves between two poses. The default is
  /// valid for a solid of revolution: the shortest rotation from axis a to axis a' moves a point by at most |a' -
  /// a| times its distance from the tip centre, and a rotation about the axis maps the body to itself.
  virtual double displacement_bound(const ToolPose& from, const ToolPose& to) const noexcept {
    const double moved = (to.position - from.position).norm();
    // In most steps the tool does not rotate. Adding a zero rotation would not change the result.
    if (to.axis == from.axis) return moved;
    return moved + (to.axis - from.axis).norm() * reach_;
  }

  // Depth models. Precondition: the contacts lie in the body or on its surface.

  /// Writes the distance from each contact to the closest point of the body's surface as the depth of the contact [m].
  /// This function and the following functions may overwrite the whole last pack of the contacts, including its
  /// padding.
  virtual void shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept = 0;
  /// Writes the unit vector from each contact to the closest point of the surface as its gradient. If there are several
  /// closest points, the shape selects one. Writes the contact's negative normal if the direction is undefined, for
  /// example on the axis of a cylinder.
  virtual void shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept = 0;
  /// Writes the exit distance [m] of each contact i to exits[i]: the ray that starts at the contact in the direction of
  /// its gradient leaves the body at this distance. The distance is finite and >= 0, also for points on the surface.
  virtual void exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept = 0;

  // Proxy (virtual tool that stays outside of the surface). The guarantee below holds for a convex body. A shape
  // that is not convex documents what it returns instead.

  /// Writes linear constraints that keep nearby points out of the body. For each contact i, with g_i the signed
  /// distance from the point to the body's surface (negative inside): depth d_i = -g_i [m], and gradient m_i =
  /// outward normal at the closest point of the surface. Calls contacts.pad().
  ///
  /// The signed distance to a convex body is a convex function of the point, and m_i is one of its subgradients.
  /// After the body is moved by a displacement x, its distance from the point is at least g_i - <m_i, x>, hence
  ///
  ///     d_i + <m_i, x> <= 0   =>   the point is not inside the moved body,
  ///
  /// for displacements of any length. If the closest point is not unique, this holds for the normal at any of the
  /// closest points.
  ///
  /// With these constraints alone, a flat face that slides along a surface would be stopped by the points ahead of it:
  /// the points lie in the plane of the face, and their closest point on the body is the edge of the face. A point that
  /// lies beyond both faces of an edge, or at most `slack` [m] inside one of the faces, is kept out by the constraint
  /// of either face. Therefore, if the displacement `wanted` [m] violates the constraint at the closest point, this
  /// constraint is replaced by the constraint of a flat face, if the face is flush (kFlush) with the surface around the
  /// contact. The normal of this surface is the contact's normal.
  virtual void surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                                   ContactBuffer& contacts) const noexcept = 0;
  /// Writes the support point of the body in the direction -n_i for each contact normal n_i: argmin <q, n_i> over
  /// the points q of the body. If the support point is not unique, writes a support point near the contact.
  virtual void support_points(const ToolPose& pose, const ContactBuffer& contacts,
                              const MutablePointArrays& surface_points) const noexcept = 0;

  /// Shape that encloses the body with a margin. Its tip centre lies `forward` [m] ahead of the body's tip centre,
  /// along the axis.
  struct Grown {
    std::unique_ptr<const ToolShape> shape;
    double forward;
  };
  /// Returns a shape that contains every point within `margin` [m] of this shape, and possibly some points slightly
  /// farther away. Precondition: margin >= 0. Allocates.
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
