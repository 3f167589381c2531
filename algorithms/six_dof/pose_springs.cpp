#include "algorithms/six_dof/pose_springs.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "algorithms/six_dof/turns.hpp"

namespace hapbench::six_dof {
namespace {

Mat3 symmetric(const Mat3& m) noexcept {
  return 0.5 * (m + m.transpose());
}

/// Returns `rest` plus the second derivative of K/2 |w|^2 with respect to the handle's rotation, with w = x + c e - q*,
/// `arm` = c e and `force` = K w (symbols: see PoseSprings). Omits the term with the second derivative of e if this
/// term would make the sum indefinite, which can happen with a large force towards the grip.
Mat3 grip_hessian(const PoseSprings& springs, const Vec3& arm, const Vec3& force, const Mat3& rest) noexcept {
  const Mat3 cross = cross_matrix(arm);
  const Mat3 first = springs.stiffness * cross.transpose() * cross;
  const Mat3 second = symmetric(arm * force.transpose()) - arm.dot(force) * Mat3::Identity();
  const Mat3 whole = rest + first + second;
  return Eigen::LLT<Mat3>(whole).info() == Eigen::Success ? whole : Mat3(rest + first);
}

}  // namespace

bool PoseSprings::handle_turns() const noexcept {
  return std::isfinite(hand_rotation);
}

CoupledPose relaxed(const PoseSprings& springs) noexcept {
  CoupledPose pose{springs.grip_target, springs.target, springs.target};
  pose.position -= springs.grip * pose.axis();
  return pose;
}

EnergyModel energy_model(const PoseSprings& springs, const CoupledPose& pose) noexcept {
  const double K = springs.stiffness, K_r = springs.coupling_rotation;
  const Vec3 twist = turn_between(pose.handle, pose.orientation);
  const Mat3 derivative = rotation_vector_derivative(twist);
  const Vec3 force = spring_force(springs, pose);
  // Derivatives with respect to the tool's pose.
  EnergyModel model;
  model.tool_gradient << force, K_r * twist;
  model.gradient = model.tool_gradient;
  model.hessian.setZero();
  model.hessian.topLeftCorner<3, 3>() = K * Mat3::Identity();
  model.hessian.bottomRightCorner<3, 3>() = K_r * symmetric(derivative);
  model.handle_gradient.setZero();
  model.handle_turn.setZero();
  model.handle_follows.setZero();
  if (!springs.handle_turns()) return model;
  // Derivatives with respect to the handle's rotation, and mixed derivatives.
  const Vec3 yield = turn_between(springs.target, pose.handle);
  const Vec3 arm = springs.grip * pose.handle_axis();
  model.handle_gradient = springs.hand_rotation * yield - K_r * twist + arm.cross(force);
  const Mat3 rest = K_r * symmetric(derivative) + springs.hand_rotation * symmetric(rotation_vector_derivative(yield));
  const Mat3 inverse = grip_hessian(springs, arm, force, rest).inverse();
  Eigen::Matrix<double, 6, 3> mixed;  // derivative of the tool's gradient with respect to the handle's rotation
  mixed << -K * cross_matrix(arm), -K_r * derivative.transpose();
  // Eliminate the handle's rotation.
  model.handle_turn = -inverse * model.handle_gradient;
  model.handle_follows = -inverse * mixed.transpose();
  model.gradient += mixed * model.handle_turn;
  model.hessian += mixed * model.handle_follows;
  model.hessian = 0.5 * (model.hessian + model.hessian.transpose()).eval();
  return model;
}

void move(CoupledPose& pose, const EnergyModel& model, const Vec6& z) noexcept {
  pose.position += z.head<3>();
  pose.orientation = turned(pose.orientation, z.tail<3>());
  pose.handle = turned(pose.handle, model.handle_turn + model.handle_follows * z);
}

Vec3 spring_force(const PoseSprings& springs, const CoupledPose& pose) noexcept {
  return springs.stiffness * (pose.position + springs.grip * pose.handle_axis() - springs.grip_target);
}

Vec3 spring_torque(const PoseSprings& springs, const CoupledPose& pose) noexcept {
  return springs.coupling_rotation * turn_between(pose.handle, pose.orientation);
}

}  // namespace hapbench::six_dof
