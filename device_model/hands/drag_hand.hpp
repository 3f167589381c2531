#pragma once

#include <memory>

#include "device_model/hands/surface_path.hpp"
#include "sim/core/profile.hpp"
#include "sim/loop/hand.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// How a hand drags the tool.
struct Drag {
  Profile force{1.0};            ///< along the inward normal, over time [N]
  double speed = 0.01;           ///< along the path [m/s]
  double stiffness = 300.0;      ///< tangential, towards the point that moves along the path [N/m]
  double damping = 6.0;          ///< tangential, beside it [N s/m]
  double normal_damping = 50.0;  ///< along the normal [N s/m]; lowers the tool at force / normal_damping
};

/// A hand that drags the tool over a surface with a given force along the surface's normal. With q the point that moves
/// along the path at the given speed, x the handle, v its velocity and n the outward normal of the surface there, read
/// where the path is nearest to the handle,
///
///   f = -F n + (I - n n^T) (k (q - x) + b (dq/dt - v)) - b_n <v, n> n.
///
/// Along the normal there is nothing but the force and a damping, so the tool presses with F whatever the stiffness of
/// what it rests on; before the first contact the same rule lowers it. Normals of the path alone would not do: pressed
/// with F along a fixed direction, a tool slides off a ridge of radius r sideways once F / r > k. The hand knows the
/// path and the normals about it, made from the shell before the run, and where the handle is: nothing of the rendered
/// force, so it is the same hand for every algorithm. A step costs a dozen look-ups in the path's table and allocates
/// nothing.
class DragHand final : public Hand {
 public:
  DragHand(Drag drag, std::shared_ptr<const SurfacePath> path);

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

/// The wrist of that hand: holds the tool's axis at an angle to the normal at the point that moves along the path. The
/// position is free. Reads the path's table, allocates nothing.
class DragOrientation final : public Motion {
 public:
  /// The tool leans by `tilt` from the outward normal towards the direction of travel turned by `azimuth` about the
  /// normal [rad]; `speed` as in Drag.
  DragOrientation(std::shared_ptr<const SurfacePath> path, double speed, double tilt, double azimuth);

  Vec3 axis_at(double t) const noexcept override;
  double roll_at(double t) const noexcept override;
  bool position_is_free() const noexcept override { return true; }
  Vec3 position_at(double) const noexcept override { return Vec3::Zero(); }

 private:
  Orientation frame_at(double t) const noexcept;

  std::shared_ptr<const SurfacePath> path_;
  double speed_;
  double tilt_;
  double azimuth_;
};

}  // namespace hapbench
