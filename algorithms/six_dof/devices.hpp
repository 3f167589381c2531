#pragma once

#include <memory>

#include "algorithms/rendering_config.hpp"
#include "algorithms/six_dof/tool_equilibrium.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/loop/force_algorithm.hpp"

/// Quasi-static devices in the hand of a user: one device renders force and torque (6-DOF), the other renders only a
/// force (3-DOF). Both follow the same path of the hand's intent, which starts in free space.
namespace hapbench::six_dof {

/// Springs of a hand that holds a handle, and of the coupling between handle and tool.
struct HandAndCoupling {
  double coupling = 0.0;           ///< K_t, translational stiffness of the coupling [N/m]
  double coupling_rotation = 0.0;  ///< K_r, rotational stiffness of the coupling [N m/rad]
  double hand = 0.0;               ///< K_h, translational stiffness of the hand [N/m]
  double hand_rotation = 0.0;      ///< K_phi, rotational stiffness of the hand about the grip [N m/rad]
  double force_point = 0.0;        ///< distance from the tip centre to the force point, away from the tip [m]
  double grip = 0.0;               ///< c, distance from the force point to the grip, towards the tip [m]

  /// Returns K_r K_phi / (K_r + K_phi) [N m/rad]. A proxy with this rotational stiffness renders the force of a 6-DOF
  /// device if the grip is at the force point.
  double matched_rotation() const noexcept;
};

/// Pose to which the hand pulls the handle.
struct Intent {
  Vec3 grip = Vec3::Zero();                                         ///< q*, position of the grip [m]
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< phi*, from the tool frame to the world frame
};

/// Pose of a handle, and the force and torque that the device renders at this pose.
struct Handle {
  Vec3 position = Vec3::Zero();  ///< p, the force point [m]
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Vec3 force = Vec3::Zero();   ///< force on the handle [N]
  Vec3 torque = Vec3::Zero();  ///< torque on the handle about the force point [N m]
};

/// Largest motion of a point of the tool in one sub-step, relative to the tool's half width. If a step of the hand's
/// intended pose (Intent) moves the tool farther, the step is bisected, at most kBisections times. If a sub-step of
/// 1/64 of the step still moves the tool farther, the motion counts as a jump.
inline constexpr double kJump = 0.1;
inline constexpr int kBisections = 6;

/// Reference device that renders force and torque: tool, coupling and hand are in equilibrium, at a local minimum of
/// the energy. When the intent changes continuously, the device follows the local minimum that changes continuously
/// with the intent. This local minimum need not be the global minimum: for a tool in a hole, the global minimum may lie
/// outside of the hole.
class SixDofDevice {
 public:
  /// Shell and tool must outlive the device.
  SixDofDevice(const PointShell& shell, const ToolShape& tool, const HandAndCoupling& springs, Skips skips);

  void reset() noexcept;
  /// Result of follow().
  struct Step {
    /// True if the pose is an equilibrium. False if there is no room for the tool or the search did not converge.
    bool solved = true;
    /// True if the tool jumped: in a sub-step that was not bisected again, a point of the tool moved farther than kJump
    /// allows.
    bool jumped = false;
    double residual = 0.0;  ///< largest residual of the equilibria in the step [N]; see ToolEquilibrium::Outcome
  };
  /// Moves the intent from its previous value to `intent`, and the tool to the equilibrium. The first call starts in
  /// free space. Allocates nothing.
  Step follow(const Intent& intent) noexcept;

  const Handle& handle() const noexcept { return handle_; }
  const CoupledPose& tool() const noexcept { return tool_; }
  ToolPose tool_pose() const noexcept { return equilibrium_.tool_pose(tool_.position, tool_.orientation); }

 private:
  PoseSprings springs_at(const Intent& intent) const noexcept;
  void follow_in_parts(const Intent& intent, int bisections, Step& step) noexcept;

  HandAndCoupling springs_;
  ToolEquilibrium equilibrium_;
  double jump_;  ///< kJump times the half width of the tool [m]
  bool starts_ = true;
  bool was_solved_ = true;  ///< false if the previous step was not solved; the next step is then not bisected
  Intent intent_;
  CoupledPose tool_;
  Handle handle_;
};

/// Largest imbalance between hand and device [N] that counts as an equilibrium of a ThreeDofDevice. The position of a
/// translating proxy has an error of 9 nm, which is 2e-4 N at 20 000 N/m.
inline constexpr double kBalanced = 1e-3;

/// A device that renders the force of a law and no torque. The hand yields to the force f and to its moment about the
/// grip: K_phi Log(phi*^T phi) = -c e x f, with the rotation phi and the axis e of the handle, the intended rotation
/// phi* and the distance c from the force point to the grip.
class ThreeDofDevice {
 public:
  /// `config`: the force law or proxy, and its stiffness. `dt`: time step [s]. Shell and tool must outlive the device.
  ThreeDofDevice(const PointShell& shell, const ToolShape& tool, const HandAndCoupling& springs,
                 const RenderingConfig& config, double dt);

  void reset() noexcept;
  /// Finds the equilibrium near the equilibrium of the previous call, by Newton's method with a line search. Returns
  /// the remaining imbalance between hand and device [N]. If it exceeds kBalanced, the law has no equilibrium nearby;
  /// this happens if the force of the law jumps. Allocates nothing.
  double follow(const Intent& intent) noexcept;
  const Handle& handle() const noexcept { return handle_; }

 private:
  void place(const Intent& intent, const Vec3& force) noexcept;
  double balance(const Intent& intent) noexcept;
  Vec3 settled(const Intent& intent, const Vec3& force) noexcept;
  Vec3 unbalanced(const Intent& intent, const Vec3& force) noexcept;

  const ToolShape* tool_;
  HandAndCoupling springs_;
  std::unique_ptr<ContactSource> source_;
  std::unique_ptr<ForceAlgorithm> law_;
  ContactBuffer contacts_;
  double step_;  ///< largest motion of the tool in a sub-step, and of the handle in a Newton step [m]
  bool starts_ = true;
  Intent from_;
  Handle handle_;
};

}  // namespace hapbench::six_dof
