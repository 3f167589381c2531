#pragma once

#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/contact/grid_index.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/device.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// A point shell as a smooth surface: place and normal are averages over the shell's points within a radius R.
///
/// The neighbours p_i of a place x are the points with |p_i - x| < R whose normals are within a right angle of the
/// normal of the shell point nearest to the queried place; this excludes the far side of a thin wall. With the weights
/// w_i = (1 - |p_i - x|^2 / R^2)^2, the normalised normal n = sum w_i n_i and the centre c = sum w_i p_i / sum w_i, the
/// surface near x is the plane through c with the normal n (a moving least-squares surface: Levin 1998; Alexa and
/// Adamson 2004).
class SmoothedSurface {
 public:
  /// `radius` R > 0 [m]. The shell must have a point and outlive this object. O(points).
  SmoothedSurface(const PointShell& shell, double radius) : shell_(shell), grid_(shell), radius_(radius) {}

  double radius() const { return radius_; }
  /// Returns the place of the surface below or above `at` and the outward normal there. Starts at the nearest shell
  /// point and projects `at` three times onto the plane near the last place; stops before a place without neighbours,
  /// such as one further than R beyond an edge. Visits all points within about `at`'s distance from the shell once and
  /// those within R three times.
  SurfacePoint nearest(const Vec3& at) const;

 private:
  std::size_t nearest_point(const Vec3& at) const;

  const PointShell& shell_;
  GridIndex grid_;
  double radius_;
};

/// A path over a surface, with the surface's normals on it and up to two smoothing radii to either side, as tables over
/// the arc length. Computed before a run from the shell alone, so it does not depend on how a force is rendered.
class SurfacePath {
 public:
  /// Over the surface below (or above) the straight legs between `points`, of which there are at least two [m].
  static SurfacePath over(const SmoothedSurface& surface, std::span<const Vec3> points);
  /// From the place nearest to `start` for `length` [m], always along the component of `direction` within the surface.
  /// Ends earlier where the surface ends or turns against the direction, to within about 6 degrees.
  static SurfacePath along(const SmoothedSurface& surface, const Vec3& start, const Vec3& direction, double length);

  /// Largest distance between entries [m]: a tenth of the radius over which the surface is smoothed.
  static double spacing(double radius) { return 0.1 * radius; }

  double length() const noexcept { return spacing_ * static_cast<double>(entries_.size() - 1); }
  /// Position and normal at arc length s [m]; constant beyond the ends.
  SurfacePoint at(double s) const noexcept;
  /// Unit vector along the path at s, within the surface. It points from one smoothing radius before s to one after, so
  /// it turns steadily around corners. Any direction within the surface if the path has none.
  Vec3 direction(double s) const noexcept;
  /// The outward normal of the surface near x, if s is the place of the path nearest to x. Takes into account that the
  /// surface may bend to the sides of the path; constant beyond two smoothing radii.
  Vec3 normal_near(const Vec3& x, double s) const noexcept;

 private:
  /// Makes entries at equal distances on the path through `places`, in their order.
  SurfacePath(const SmoothedSurface& surface, std::span<const SurfacePoint> places);

  static constexpr std::size_t kSide = 2;  ///< columns either side of the path, a smoothing radius apart
  using Normals = std::array<Vec3, 2 * kSide + 1>;

  /// The place of s between two entries.
  struct Position {
    std::size_t before, after;
    double fraction;
  };
  Position position(double s) const noexcept;

  double radius_;
  double spacing_;                     ///< distance between entries [m]
  std::vector<SurfacePoint> entries_;  ///< at least one
  std::vector<Normals> normals_;       ///< for each entry, from right to left
};

/// Parameters of a DragHand.
struct Drag {
  Profile force{1.0};            ///< along the inward normal, over time [N]
  double speed = 0.01;           ///< along the path [m/s]
  double stiffness = 300.0;      ///< tangential, towards the point q that moves along the path [N/m]
  double damping = 6.0;          ///< tangential [N s/m]
  double normal_damping = 50.0;  ///< along the normal [N s/m]; the tool is lowered at force / normal_damping
};

/// A hand that drags the tool over a surface with a given force along the surface's normal. With q the point that moves
/// along the path at the given speed, x the handle, v its velocity and n the outward normal of the surface there, read
/// where the path is nearest to the handle,
///
///   f = -F n + (I - n n^T) (k (q - x) + b (dq/dt - v)) - b_n <v, n> n.
///
/// Along the normal there are only the force and a damping, so the tool presses with F independent of the stiffness of
/// the surface. Before the first contact the same rule lowers it. Normals on the path alone would not suffice: pressed
/// with F along a fixed direction, a tool slides sideways off a ridge of radius r if F / r > k. The hand does not know
/// the rendered force, so it is the same for every algorithm. A step takes a dozen look-ups and allocates nothing.
class DragHand final : public Hand {
 public:
  DragHand(Drag drag, std::shared_ptr<const SurfacePath> path) : drag_(std::move(drag)), path_(std::move(path)) {}

  void reset() noexcept override { nearest_ = 0.0; }
  Vec3 force(double t, const HandView& view) noexcept override;

  const Drag& drag() const noexcept { return drag_; }
  const SurfacePath& path() const noexcept { return *path_; }
  /// Arc length at which the path was nearest to the handle at the last force [m].
  double nearest() const noexcept { return nearest_; }

 private:
  Drag drag_;
  std::shared_ptr<const SurfacePath> path_;
  double nearest_ = 0.0;  ///< arc length at which the path is nearest to the handle [m]
};

/// The wrist of a DragHand: holds the axis of the tool at an angle to the normal at the point that moves along the
/// path. The position is free. Allocates nothing.
class DragOrientation final : public Motion {
 public:
  /// The tool leans by `tilt` from the outward normal towards the direction of travel turned by `azimuth` about the
  /// normal [rad]; `speed` as in Drag.
  DragOrientation(std::shared_ptr<const SurfacePath> path, double speed, double tilt, double azimuth)
      : path_(std::move(path)), speed_(speed), tilt_(tilt), azimuth_(azimuth) {}

  Vec3 axis_at(double t) const noexcept override { return tool_axis(frame_at(t), tilt_, azimuth_); }
  double roll_at(double t) const noexcept override { return tool_roll(frame_at(t), tilt_, azimuth_, 0.0); }

 private:
  Orientation frame_at(double t) const noexcept {
    const double s = speed_ * t;
    return {path_->at(s).normal, path_->direction(s), {}, {}};
  }

  std::shared_ptr<const SurfacePath> path_;
  double speed_;
  double tilt_;
  double azimuth_;
};

}  // namespace hapbench
