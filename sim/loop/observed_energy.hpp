#pragma once

#include "sim/loop/force_algorithm.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// Time-domain passivity observer (Hannaford and Ryu, 2002). It computes the energy E [J] that a rendering has
/// absorbed and can still return. The two ports are the tool's translation and its scripted rotation:
///
///   E_0 = E_spring(0),  E_(k+1) = E_k - f_render_k . (v_k + v_(k+1))/2 dt - (m_k + m_(k+1))/2 . turn_k
///
/// v_k is the velocity of the tip centre in step k, dt the time step, m_k the moment of the springs about the tip
/// centre, and turn_k the rotation vector from pose k to pose k + 1. The energy balance of a run uses the same work
/// terms. For a rendering that only stores energy in springs and dissipates, E_k is never negative. max(0, -min E_k) is
/// the created energy. Dissipated energy counts as absorbed, so it can hide energy that is created later.
///
/// If a device's handle moves the tool, the force is held while the tool moves, and its work is f_render_k .
/// (p_(k+1) - p_k), with the position p_k of the tip centre. E then also includes the energy created by sampling the
/// position and holding the force. If a script prescribes the position, the force is not held: its work is the
/// integral along the path by the trapezoidal rule, (f_k + f_(k+1))/2 . (p_(k+1) - p_k). If a contact of stiffness K
/// begins or ends between two steps whose positions are d apart, this rule has an error of up to K d^2 / 8.
///
/// Call `move`, then `answer` in every step. The passivity observer and the passivity controller share this code, so
/// their results agree bitwise. A step without force and moment costs a few comparisons and a copy of the pose.
class ObservedEnergy {
 public:
  /// `dt`: time step [s]. `position_is_free`: false if a script prescribes the tool's position.
  explicit ObservedEnergy(double dt, bool position_is_free = true) : dt_(dt), free_(position_is_free) {}

  /// Resets the observer to t = 0.
  void reset() noexcept { *this = ObservedEnergy(dt_, free_); }

  /// Begins the next step. `tool` is the tool's state in this step. `handle_moves_tool`: true if the tool follows the
  /// handle of a device.
  void move(const ToolState& tool, bool handle_moves_tool = false) noexcept {
    first_ = !begun_;
    begun_ = true;
    current_ = !current_;
    set_pose(tool.pose);
    if (force_acts_) energy_ -= (free_ ? 1.0 : 0.5) * force_.dot(displacement_to(tool, handle_moves_tool));
    if (moment_acts_) energy_ -= 0.5 * moment_.dot(turned());
  }
  /// Ends the step. `rendered` [N] and `springs` act on the tool that was passed to `move`.
  void answer(const ToolState& tool, const Vec3& rendered, const SpringState& springs) noexcept {
    if (first_) energy_ = springs.energy;
    force_acts_ = !is_zero(rendered);
    moment_acts_ = !is_zero(springs.moment);
    if (force_acts_) {
      force_ = rendered;
      if (!free_ && !first_) energy_ -= 0.5 * force_.dot(tool.pose.position - pose_[!current_].position);
      velocity_ = tool.velocity;
    }
    if (moment_acts_) {
      moment_ = springs.moment;
      energy_ -= 0.5 * moment_.dot(turned());
    }
  }

  /// Returns true if neither the previous nor this step renders a force or a moment.
  bool rests(const Vec3& rendered, const SpringState& springs) const noexcept {
    return begun_ && !force_acts_ && !moment_acts_ && is_zero(rendered) && is_zero(springs.moment);
  }
  /// Cheaper equivalent of `move` and `answer`. Precondition: `rests` returns true for this step.
  void rest(const ToolState& tool) noexcept {
    first_ = false;
    current_ = !current_;
    set_pose(tool.pose);
  }

  /// Returns E [J]. Between `move` and `answer`, E does not yet include the work of this step's moment and, if a script
  /// prescribes the position, of this step's force.
  double energy() const { return energy_; }
  /// Returns true in the first step, in which E starts from the energy of the springs.
  bool first() const { return first_; }
  /// Returns the rotation vector from the previous step's pose to this step's pose [rad].
  const Vec3& turned() noexcept {
    if (!turn_is_known_) turn_ = first_ ? Vec3(Vec3::Zero()) : turn(pose_[!current_], pose_[current_]);
    turn_is_known_ = true;
    return turn_;
  }

 private:
  /// Displacement since the previous step [m]. The force of the previous step does work over this displacement.
  Vec3 displacement_to(const ToolState& tool, bool handle_moves_tool) const noexcept {
    if (handle_moves_tool || !free_) return tool.pose.position - pose_[!current_].position;
    return 0.5 * (velocity_ + tool.velocity) * dt_;
  }
  /// Returns true if all components are zero. Branch-free, unlike Eigen's isZero.
  static bool is_zero(const Vec3& v) noexcept { return (v.x() == 0.0) & (v.y() == 0.0) & (v.z() == 0.0); }

  void set_pose(const ToolPose& pose) noexcept {
    pose_[current_] = pose;
    turn_is_known_ = false;
  }

  double dt_;
  bool free_;  ///< true if the position is integrated, false if it is prescribed
  double energy_ = 0.0;
  bool begun_ = false;
  bool first_ = false;
  bool force_acts_ = false;
  bool moment_acts_ = false;
  bool turn_is_known_ = false;
  bool current_ = false;          ///< index in pose_ of this step's pose
  ToolPose pose_[2];              ///< poses of this step and of the previous step
  Vec3 velocity_ = Vec3::Zero();  ///< velocity in the last step with a force [m/s]
  Vec3 turn_ = Vec3::Zero();
  Vec3 force_ = Vec3::Zero();
  Vec3 moment_ = Vec3::Zero();
};

}  // namespace hapbench
