#pragma once

#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/loop/device.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// Smooth surface through a point shell: position and normal are weighted averages over the shell's points within a
/// radius R.
///
/// A moving least-squares surface (Levin 1998; Alexa and Adamson 2004). The neighbours of a position x are the
/// shell points p_i with |p_i - x| < R whose normals n_i are within 90 degrees of the normal of the shell point
/// nearest to the queried position; this excludes the far side of a thin wall. With the weights w_i = (1 - |p_i -
/// x|^2 / R^2)^2, the unit normal n along sum w_i n_i and the centre c = sum w_i p_i / sum w_i, the surface near x
/// is the plane through c with normal n.
class SmoothedSurface {
 public:
  /// `radius`: R > 0 [m]. Precondition: the shell has a point and outlives this object. Cost: O(points), if no search
  /// was made in the shell before.
  SmoothedSurface(const PointShell& shell, double radius) : shell_(shell), grid_(shell.grid()), radius_(radius) {}

  double radius() const { return radius_; }
  /// Returns the projection of `at` [m] onto the surface, and the outward normal there. The first position is the
  /// nearest shell point. Three times, the projection of `at` onto the plane of the last position's neighbours becomes
  /// the new position. Stops before a position without neighbours, for example a position further than R beyond the
  /// surface's border. Cost: visits the shell points within about a of `at` once, where a is the distance from `at` to
  /// the shell, and the shell points within R of each position.
  SurfacePoint nearest(const Vec3& at) const;

 private:
  std::size_t nearest_point(const Vec3& at) const;

  const PointShell& shell_;
  const GridIndex& grid_;
  double radius_;
};

/// Path over a surface, tabulated over the arc length. The table contains the surface's normals on the path and up to
/// two smoothing radii to either side of the path. The path is computed before a run, only from the shell, so it does
/// not depend on the rendering algorithm.
class SurfacePath {
 public:
  /// Returns the projection onto the surface of the straight legs between `points` [m]. Precondition: at least two
  /// points.
  static SurfacePath over(const SmoothedSurface& surface, std::span<const Vec3> points);
  /// Returns the path that starts at the surface position nearest to `start` [m], is `length` [m] long, and always
  /// follows the component of `direction` within the surface. Ends earlier if the surface ends, or if its normal
  /// comes within about 6 degrees of `direction`.
  static SurfacePath along(const SmoothedSurface& surface, const Vec3& start, const Vec3& direction, double length);

  double radius() const noexcept { return radius_; }
  /// Returns the largest distance between table entries [m], a tenth of the smoothing radius.
  static double spacing(double radius) { return 0.1 * radius; }

  double length() const noexcept { return spacing_ * static_cast<double>(entries_.size() - 1); }
  /// Returns position and normal at arc length s [m], linearly interpolated; constant beyond the ends.
  SurfacePoint at(double s) const noexcept;
  /// Returns a unit vector along the path at s, within the surface. It points from one smoothing radius before s to one
  /// smoothing radius after s, so it turns gradually around corners. If the path has no length, returns any unit vector
  /// within the surface.
  Vec3 direction(double s) const noexcept;
  /// Returns the surface's outward normal near the position x [m]. Precondition: s is the arc length of the path
  /// position nearest to x. Includes the curvature of the surface to the sides of the path. The normal is constant
  /// beyond two smoothing radii from the path.
  Vec3 normal_near(const Vec3& x, double s) const noexcept;

 private:
  /// Creates table entries at equal distances on the path through `points`, in the order of `points`.
  SurfacePath(const SmoothedSurface& surface, std::span<const SurfacePoint> points);

  static constexpr std::size_t kSide = 2;  ///< number of normals to either side of the path, one smoothing radius apart
  using Normals = std::array<Vec3, 2 * kSide + 1>;

  /// Indices of the entries before and after s, and the fraction of the interval between these entries at which s lies.
  struct Position {
    std::size_t before, after;
    double fraction;
  };
  Position position(double s) const noexcept;

  double radius_;
  double spacing_;                     ///< distance between entries [m]
  std::vector<SurfacePoint> entries_;  ///< positions and normals on the path, at least one
  std::vector<Normals> normals_;       ///< for each entry, normals on a line across the path, from right to left
};

/// Parameters of a DragHand.
struct Drag {
  Profile force{1.0};            ///< force F along the inward normal, over time [N]
  double speed = 0.01;           ///< speed of q along the path [m/s]
  double stiffness = 300.0;      ///< tangential stiffness k towards q, the point that moves along the path [N/m]
  double damping = 6.0;          ///< tangential damping b [N s/m]
  double normal_damping = 50.0;  ///< damping b_n along the normal [N s/m]; before contact, the tool descends at F / b_n
};

/// A hand that drags the tool over a surface with a given force F along the surface's normal. Let q be the point
/// that moves along the path at the given speed, x and v the position and velocity of the handle, and n the outward
/// normal of the surface at the path position nearest to the handle. The force is
///
///   f = -F n + (I - n n^T) (k (q - x) + b (dq/dt - v)) - b_n <v, n> n.
///
/// with k, b and b_n as in Drag. Along the normal, only F and the damping b_n act, so the tool presses with F whatever
/// the stiffness of the surface. Before the first contact, the same force lowers the tool. n must also change to the
/// sides of the path: if the direction of F were fixed there, the tool would slide sideways off a ridge of radius r if
/// F / r > k. The hand's force does not depend on the rendered force, so the hand is the same for every algorithm. A
/// step takes a dozen table look-ups and allocates nothing.
class DragHand final : public Hand {
 public:
  DragHand(Drag drag, std::shared_ptr<const SurfacePath> path) : drag_(std::move(drag)), path_(std::move(path)) {}

  void reset() noexcept override { nearest_ = progress_ = 0.0; }
  Vec3 force(double t, const HandView& view) noexcept override;
  /// Returns the linearisation with the normal n held constant, without the curvature of the surface.
  HandImpedance impedance() const noexcept override;

  const Drag& drag() const noexcept { return drag_; }
  const SurfacePath& path() const noexcept { return *path_; }
  /// Returns the arc length of the path position nearest to the handle [m], from the last call of force().
  double nearest() const noexcept { return nearest_; }
  /// Returns the arc length up to which the handle has followed the path [m], from the last call of force(). This is
  /// the arc length of the path position nearest to the handle. If several legs of the path pass equally
  /// near the handle, the position is on the leg of the moving point q.
  double progress() const noexcept { return progress_; }

 private:
  Drag drag_;
  std::shared_ptr<const SurfacePath> path_;
  void find_progress(const Vec3& x, double s) noexcept;

  double nearest_ = 0.0;         ///< see nearest() [m]
  double progress_ = 0.0;        ///< see progress() [m]
  Vec3 normal_ = Vec3::UnitZ();  ///< n of the last force()
};

/// Tool orientation of a DragHand: holds the tool's axis at an angle to the normal at the point that moves along
/// the path. The position is free. Allocates nothing.
class DragOrientation final : public Motion {
 public:
  /// The shank of the tool is tilted by `tilt` [rad] from the outward normal. The direction of the tilt is the
  /// direction of travel, rotated by `azimuth` [rad] about the normal. `speed` [m/s] as in Drag.
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
