#pragma once

#include <memory>

#include "algorithms/rendering_config.hpp"
#include "algorithms/six_dof/tool_equilibrium.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/loop/force_algorithm.hpp"

/// Quasi-static devices in the hand of a user: one that renders force and torque, and one that renders a force only.
/// Both are led along the same path of the hand's intent, from free space.
namespace hapbench::six_dof {

/// A hand that holds a handle, and the coupling between handle and tool.
struct HandAndCoupling {
  double coupling = 0.0;           ///< K_t [N/m]
  double coupling_rotation = 0.0;  ///< K_r [N m/rad]
  double hand = 0.0;               ///< K_h [N/m]
  double hand_rotation = 0.0;      ///< K_phi [N m/rad], about the grip
  double force_point = 0.0;        ///< distance from the tip centre back to the force point [m]
  double grip = 0.0;               ///< c, distance from the force point to the grip, towards the tip [m]

  /// K_r K_phi / (K_r + K_phi): the rotational stiffness with which a proxy renders the force of a 6-DOF device, if the
  /// grip is the force point.
  double matched_rotation() const noexcept;
};

/// Where the hand wants the handle.
struct Intent {
  Vec3 grip = Vec3::Zero();                                         ///< q* [m]
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< phi*, from the tool frame to the world frame
};

/// Pose of a handle, and what the device renders there.
struct Handle {
  Vec3 position = Vec3::Zero();  ///< p, the force point [m]
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Vec3 force = Vec3::Zero();   ///< on the handle [N]
  Vec3 torque = Vec3::Zero();  ///< about the force point [N m]
};

/// A tool that sub-steps follow: when a step of the intent moves the tool by more than this fraction of its half
/// width, the step is bisected, kBisections times at most. A sub-step of 1/64 that still moves the tool so far is a
/// jump.
inline constexpr double kJump = 0.1;
inline constexpr int kBisections = 6;

/// The reference: tool, coupling and hand in equilibrium, with force and torque. The equilibrium is the local minimum
/// of the energy that continuation of the intent reaches, and not the global one, which in a hole may lie outside of
/// it.
class SixDofDevice {
 public:
  /// Shell and tool must outlive the device.
  SixDofDevice(const PointShell& shell, const ToolShape& tool, const HandAndCoupling& springs, Skips skips);

  void reset() noexcept;
  /// Follows the intent from that of the call before; the first call starts in free space. Allocates nothing.
  struct Step {
    bool solved = true;     ///< the pose is an equilibrium; false: no room for the tool, or no convergence
    bool jumped = false;    ///< the pose is no continuation of the one before
    double residual = 0.0;  ///< largest residual of the step's equilibria [N]; see ToolEquilibrium::Outcome
  };
  Step follow(const Intent& intent) noexcept;

  const Handle& handle() const noexcept { return handle_; }
  const CoupledPose& tool() const noexcept { return tool_; }
  ToolPose tool_pose() const noexcept { return equilibrium_.tool_pose(tool_.position, tool_.orientation); }

 private:
  PoseSprings springs_at(const Intent& intent) const noexcept;
  void follow_in_parts(const Intent& intent, int bisections, Step& step) noexcept;

  HandAndCoupling springs_;
  ToolEquilibrium equilibrium_;
  double jump_;  ///< [m]
  bool starts_ = true;
  bool was_solved_ = true;  ///< false: the step before was not solved, so that this step is not bisected
  Intent intent_;
  CoupledPose tool_;
  Handle handle_;
};

/// Largest force [N] by which hand and device may differ in an equilibrium of a ThreeDofDevice. The proxy that
/// translates is exact to 9 nm, which are 2e-4 N at 20 000 N/m.
inline constexpr double kBalanced = 1e-3;

/// A device that renders the force of a law, and no torque: the hand yields to the force and to its moment about the
/// grip, K_phi Log(phi*^T phi) = -c e x f.
class ThreeDofDevice {
 public:
  /// Shell and tool must outlive the device. `config`: the law, with its own stiffness.
  ThreeDofDevice(const PointShell& shell, const ToolShape& tool, const HandAndCoupling& springs,
                 const RenderingConfig& config, double dt);

  void reset() noexcept;
  /// Finds the equilibrium near that of the call before, by Newton's method with a line search. Returns the force
  /// [N] by which hand and device differ. Above kBalanced the law has no equilibrium nearby, as where its force jumps
  /// past the hand's. Allocates nothing.
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
