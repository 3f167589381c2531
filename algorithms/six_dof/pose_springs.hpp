#pragma once

#include <Eigen/Geometry>

#include "sim/core/types.hpp"

/// Springs that hold the pose of a tool: the coupling of a haptic device in series with the hand.
namespace hapbench::six_dof {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Springs between the pose (x, theta) of the tool and the intent (q*, phi*) of a hand. Their energy is
///
///   E = K/2 |x + c e - q*|^2 + K_r/2 |Log(phi^T theta)|^2 + K_phi/2 |Log(phi*^T phi)|^2.
///
/// x [m] is the force point of the tool, where the device measures and applies its force, and theta is the rotation of
/// the tool. phi is the rotation of the handle, and e its axis, which points out of the tip. The grip is at p + c e,
/// where p is the handle's force point; the hand pulls the grip to q*. K = K_t K_h / (K_t + K_h) is the stiffness of
/// coupling (K_t) and hand (K_h) in series, because p is eliminated exactly. If K_phi is infinite, phi = phi*.
struct PoseSprings {
  double stiffness = 0.0;                                      ///< K [N/m], of coupling and hand in series
  double coupling_rotation = 0.0;                              ///< K_r [N m/rad], of the coupling
  double hand_rotation = 0.0;                                  ///< K_phi [N m/rad], of the hand; may be infinite
  double grip = 0.0;                                           ///< c [m], from force point to grip, towards the tip
  Vec3 grip_target = Vec3::Zero();                             ///< q*, to which the hand pulls the grip [m]
  Eigen::Quaterniond target = Eigen::Quaterniond::Identity();  ///< phi*, from the tool frame to the world frame

  bool handle_turns() const noexcept;
};

/// Pose of the tool and rotation of the handle.
struct CoupledPose {
  Vec3 position = Vec3::Zero();                                     ///< x [m], force point of the tool
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< theta
  Eigen::Quaterniond handle = Eigen::Quaterniond::Identity();       ///< phi

  Vec3 axis() const noexcept { return orientation * Vec3(0.0, 0.0, -1.0); }
  Vec3 handle_axis() const noexcept { return handle * Vec3(0.0, 0.0, -1.0); }
};

/// Returns the pose in which the springs are relaxed.
CoupledPose relaxed(const PoseSprings& springs) noexcept;

/// The energy near a pose as a function of the motion z = (dx, dtheta) of the tool [m, rad]. The handle's rotation is
/// eliminated: it minimises the quadratic model.
struct EnergyModel {
  Vec6 tool_gradient;    ///< derivative with respect to z if the handle does not rotate [N, N m]
  Vec6 gradient;         ///< derivative with respect to z if the handle rotates to the minimum [N, N m]
  Mat6 hessian;          ///< symmetric [N/m, N, N m/rad]
  Vec3 handle_gradient;  ///< derivative with respect to the handle's rotation [N m]
  Vec3 handle_turn;      ///< rotation of the handle to the minimum if the tool does not move [rad]
  Eigen::Matrix<double, 3, 6> handle_follows;  ///< the handle rotates by handle_turn + handle_follows z [rad]
};
EnergyModel energy_model(const PoseSprings& springs, const CoupledPose& pose) noexcept;

/// Moves the tool by z = (dx, dtheta) and rotates the handle by the rotation that minimises the model.
void move(CoupledPose& pose, const EnergyModel& model, const Vec6& z) noexcept;

/// Returns the force K (x + c e - q*) on the handle [N].
Vec3 spring_force(const PoseSprings& springs, const CoupledPose& pose) noexcept;
/// Returns the moment K_r Log(phi^T theta) on the handle about the force point [N m].
Vec3 spring_torque(const PoseSprings& springs, const CoupledPose& pose) noexcept;

}  // namespace hapbench::six_dof
