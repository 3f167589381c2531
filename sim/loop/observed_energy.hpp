#pragma once

#include "sim/loop/force_algorithm.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// The time-domain passivity observer (Hannaford and Ryu, 2002): the energy that a rendering has absorbed and can still
/// return, with the tool's translation as one port and its scripted rotation as the other,
///
///   E_0 = E_spring(0),  E_(k+1) = E_k - f_render_k . (v_k + v_(k+1))/2 dt - (m_k + m_(k+1))/2 . turn_k
///
/// with m the moment of the springs and turn_k the rotation vector from pose k to pose k + 1. The works are those of
/// the energy ledger. A rendering that only stores energy in springs and dissipates never has E_k < 0; max(0, -min E_k)
/// is created energy. Dissipation counts as absorbed, so it can hide energy created later.
///
/// If the handle of a device moves the tool, the work is that of the force held while the tool moves on,
/// f_render_k . (p_(k+1) - p_k), and E is that of the display, including the energy created by sampling and holding. A
/// prescribed motion holds nothing: its work is the integral along the way by the trapezoidal rule,
/// (f_k + f_(k+1))/2 . (p_(k+1) - p_k), which is off by up to K d^2 / 8 where a contact of stiffness K begins or ends
/// between two rows d apart.
///
/// A row is `move`, then `answer`. Observer and controller share this code, so that they agree to the last bit.
/// Without force and moment a row costs a few comparisons and the copy of a pose.
class ObservedEnergy {
 public:
  explicit ObservedEnergy(double dt, bool position_is_free = true) : dt_(dt), free_(position_is_free) {}

  /// Returns to t = 0.
  void reset() noexcept { *this = ObservedEnergy(dt_, free_); }

  /// Starts the next row; `tool` is the tool's state in it.
  void move(const ToolState& tool, bool handle_moves_tool = false) noexcept {
    first_ = !begun_;
    begun_ = true;
    now_ = !now_;
    note(tool.pose);
    if (force_acts_) energy_ -= (free_ ? 1.0 : 0.5) * force_.dot(way_to(tool, handle_moves_tool));
    if (moment_acts_) energy_ -= 0.5 * moment_.dot(turned());
  }
  /// Ends the row: `rendered` and `springs` act on the tool passed to `move`.
  void answer(const ToolState& tool, const Vec3& rendered, const SpringState& springs) noexcept {
    if (first_) energy_ = springs.energy;
    force_acts_ = !is_zero(rendered);
    moment_acts_ = !is_zero(springs.moment);
    if (force_acts_) {
      force_ = rendered;
      if (!free_ && !first_) energy_ -= 0.5 * force_.dot(tool.pose.position - pose_[!now_].position);
      velocity_ = tool.velocity;
    }
    if (moment_acts_) {
      moment_ = springs.moment;
      energy_ -= 0.5 * moment_.dot(turned());
    }
  }

  /// True if neither the last row nor this one renders a force or a moment.
  bool rests(const Vec3& rendered, const SpringState& springs) const noexcept {
    return begun_ && !force_acts_ && !moment_acts_ && is_zero(rendered) && is_zero(springs.moment);
  }
  /// Cheaper equivalent of `move` and `answer` for a row for which `rests` is true.
  void rest(const ToolState& tool) noexcept {
    first_ = false;
    now_ = !now_;
    note(tool.pose);
  }

  /// E [J]. After `move` but before `answer` it does not yet include the work of this row's moment.
  double energy() const { return energy_; }
  /// True in the first row, which starts from the springs' energy.
  bool first() const { return first_; }
  /// The turn from the previous row to this one [rad].
  const Vec3& turned() noexcept {
    if (!turn_is_known_) turn_ = first_ ? Vec3(Vec3::Zero()) : turn(pose_[!now_], pose_[now_]);
    turn_is_known_ = true;
    return turn_;
  }

 private:
  /// Displacement since the previous row over which its force acts [m].
  Vec3 way_to(const ToolState& tool, bool handle_moves_tool) const noexcept {
    if (handle_moves_tool || !free_) return tool.pose.position - pose_[!now_].position;
    return 0.5 * (velocity_ + tool.velocity) * dt_;
  }
  /// Branch-free, unlike Eigen's isZero.
  static bool is_zero(const Vec3& v) noexcept { return (v.x() == 0.0) & (v.y() == 0.0) & (v.z() == 0.0); }

  void note(const ToolPose& pose) noexcept {
    pose_[now_] = pose;
    turn_is_known_ = false;
  }

  double dt_;
  bool free_;
  double energy_ = 0.0;
  bool begun_ = false;
  bool first_ = false;
  bool force_acts_ = false;
  bool moment_acts_ = false;
  bool turn_is_known_ = false;
  bool now_ = false;              ///< index of this row's pose
  ToolPose pose_[2];              ///< of this row and the previous one
  Vec3 velocity_ = Vec3::Zero();  ///< of the last row with force
  Vec3 turn_ = Vec3::Zero();
  Vec3 force_ = Vec3::Zero();
  Vec3 moment_ = Vec3::Zero();
};

}  // namespace hapbench
