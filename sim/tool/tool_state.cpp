#include "sim/tool/tool_state.hpp"

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// The matrix of the shortest turn of -z to a unit vector, by Rodrigues' formula I + [v] + [v]^2 (1 - c) / |v|^2 with
/// v = -z x axis, the turn's axis times its sine, and its cosine c = <-z, axis>.
Mat3 shortest_turn(const Vec3& axis) noexcept {
  const Vec3 v(axis.y(), -axis.x(), 0.0);
  const double sine2 = v.squaredNorm(), cosine = -axis.z();
  if (sine2 == 0.0) return cosine > 0.0 ? Mat3(Mat3::Identity()) : Mat3(Vec3(1.0, -1.0, -1.0).asDiagonal());
  Mat3 cross;
  cross << 0.0, 0.0, v.y(), 0.0, 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return Mat3::Identity() + cross + (1.0 - cosine) / sine2 * cross * cross;
}

}  // namespace

Mat3 ToolPose::rotation() const noexcept {
  return turn_about(axis, roll).toRotationMatrix() * shortest_turn(axis);
}

double roll_towards(const Vec3& axis, const Vec3& side) noexcept {
  const Vec3 x = shortest_turn(axis).col(0);
  return math::atan2(axis.cross(x).dot(side), x.dot(side));
}

Mat3 turn_matrix(const ToolPose& from, const ToolPose& to) noexcept {
  const Vec3 v = from.axis.cross(to.axis);
  const double cosine = from.axis.dot(to.axis);
  Mat3 cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  Mat3 turn = Mat3::Identity() + cross + cross * cross / (1.0 + cosine);
  if (v.squaredNorm() == 0.0 && cosine < 0.0) {  // half a turn, about any axis across
    const Vec3 across = from.axis.unitOrthogonal();
    turn = 2.0 * across * across.transpose() - Mat3::Identity();
  }
  if (to.roll == from.roll) return turn;
  return turn_about(to.axis, to.roll - from.roll).toRotationMatrix() * turn;
}

Vec3 whole_turn(const ToolPose& from, const ToolPose& to) noexcept {
  const Eigen::Quaterniond whole(Mat3(to.rotation() * from.rotation().transpose()));
  const double sine = whole.vec().norm();  // of half the angle
  if (sine == 0.0) return Vec3::Zero();
  return whole.vec() * (angle_of(whole, sine) / sine);
}

}  // namespace hapbench
