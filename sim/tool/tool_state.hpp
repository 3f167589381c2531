#pragma once

#include <Eigen/Geometry>

#include "sim/core/math.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// The tool's position, axis and roll in the world frame.
///
/// The axis is stored rather than computed from an orientation, because scripts give it and solids of revolution read
/// it; the roll completes it to a rotation. The tool's own frame has its origin at the tip centre and its axis along
/// -z.
struct ToolPose {
  Vec3 position = Vec3::Zero();  ///< centre of the tip [m]
  Vec3 axis = {0.0, 0.0, -1.0};  ///< unit vector out of the tip
  double roll = 0.0;             ///< turn about the axis, right-handed [rad]; see rotation()

  /// Rotation from the tool's frame to the world's: the shortest turn of -z to the axis (half a turn about x if the
  /// axis is +z), followed by the turn by `roll` about the axis.
  Mat3 rotation() const noexcept;
};

/// Pose and velocity. The orientation is scripted, so the angular velocity is known and not integrated.
struct ToolState {
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();  ///< of the tip centre [m/s]
  /// Over the previous step, low-passed if the algorithm asks for that [rad/s]; zero unless an algorithm reads it.
  /// Includes the turn about the axis if the pose or the script (Motion::scripts_roll) has one.
  Vec3 angular_velocity = Vec3::Zero();
};

/// The turn about a unit axis, right-handed [rad].
inline Eigen::Quaterniond turn_about(const Vec3& axis, double angle) noexcept {
  const auto [sine, cosine] = math::sine_cosine(0.5 * angle);
  Eigen::Quaterniond q;
  q.w() = cosine;
  q.vec() = sine * axis;
  return q;
}

/// The angle of the turn of a unit quaternion in (-pi, pi], about q.vec(), whose length is `sine` > 0.
inline double angle_of(const Eigen::Quaterniond& q, double sine) noexcept {
  return 2.0 * math::atan2(q.w() < 0.0 ? -sine : sine, std::abs(q.w()));
}

/// The roll of the pose with this axis whose own x axis lies along `side`, in (-pi, pi]. Unit vectors, perpendicular.
double roll_towards(const Vec3& axis, const Vec3& side) noexcept;

/// The rotation vector of the shortest turn from unit vector a to unit vector b [rad]; zero for opposite ones.
inline Vec3 turn(const Vec3& a, const Vec3& b) noexcept {
  const Vec3 cross = a.cross(b);
  const double sine = cross.norm();
  return sine > 0.0 ? Vec3(cross * (math::atan2(sine, a.dot(b)) / sine)) : Vec3::Zero();
}

/// The matrix of the shortest turn from one pose's axis to the other's, followed by the turn about that by the
/// difference of their rolls; exactly the identity where axes and rolls are equal.
Mat3 turn_matrix(const ToolPose& from, const ToolPose& to) noexcept;

/// The rotation vector that turns one pose to the other, roll included [rad].
Vec3 whole_turn(const ToolPose& from, const ToolPose& to) noexcept;

/// The same. If neither pose has a roll, it is the shortest turn of the axis, because a solid of revolution, whose pose
/// omits the roll, feels no other turn.
inline Vec3 turn(const ToolPose& from, const ToolPose& to) noexcept {
  if (from.roll == 0.0 && to.roll == 0.0) return turn(from.axis, to.axis);
  return whole_turn(from, to);
}

}  // namespace hapbench
