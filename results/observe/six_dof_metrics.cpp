#include "results/observe/six_dof_metrics.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

void SixDofMetrics::Size::add(double value) noexcept {
  squares += value * value;
  largest = std::max(largest, value);
  ++count;
}

double SixDofMetrics::Size::rms() const {
  return std::sqrt(per(squares, count));
}

std::optional<double> SixDofMetrics::Size::max() const {
  return count > 0 ? std::optional(largest) : std::nullopt;
}

void SixDofMetrics::Work::add(const Vec3& force, const Vec3& position) noexcept {
  if (last) sum += 0.5 * (last->first + force).dot(position - last->second);
  last = {force, position};
}

void SixDofMetrics::add(const SixDofRow& row) noexcept {
  residual_ = std::max(residual_, row.residual);
  jumps_ += row.jumped;
  unsolved_ += !row.reference;
  unbalanced_ += !row.law;
  if (row.law) work_.add(row.law->force, row.law->position);
  if (!row.reference) return;
  reference_force_.add(row.reference->force.norm());
  lost_torque_.add(row.reference->torque.norm());
  if (!row.law) return;
  force_error_.add((row.law->force - row.reference->force).norm());
  displacement_.add((row.law->position - row.reference->position).norm());
  turn_.add(row.law->turn);
}

void SixDofMetrics::report(Section& s) const {
  s.metric("reference_force_rms_N", "N",
           "root mean square of the force on the handle of a 6-DOF device in equilibrium with the hand (reference_x_N, "
           "reference_y_N, reference_z_N of six_dof.csv), over the steps with such an equilibrium",
           reference_force_.rms());
  s.metric("lost_torque_rms_Nm", "N m",
           "root mean square of the torque of the 6-DOF device about the force point, which a 3-DOF device does not "
           "render (torque_x_Nm, torque_y_Nm, torque_z_Nm of six_dof.csv)",
           lost_torque_.rms());
  s.metric(
      "force_error_rms_N", "N",
      "root mean square of the difference between the force of the law and the force of the 6-DOF device, over the "
      "steps in which both have an equilibrium; for comparison: a law that renders no force has the error "
      "reference_force_rms_N",
      force_error_.rms());
  s.metric("force_error_max_N", "N",
           "largest difference between the force of the law and the force of the 6-DOF device", force_error_.max());
  s.metric("ghost_displacement_rms_m", "m",
           "root mean square of the distance between the handles' force points of the 3-DOF and of the 6-DOF device",
           displacement_.rms());
  s.metric("unresisted_turn_max_rad", "rad",
           "largest angle between the handles of the 3-DOF and of the 6-DOF device: only the 6-DOF device "
           "renders a torque against the turn. With the grip at the force point it is the norm of handle_turn_x_rad, "
           "handle_turn_y_rad and handle_turn_z_rad of six_dof.csv",
           turn_.max());
  s.metric("work_J", "J",
           "work of the law's force on the handle, by the trapezoidal rule over the steps in equilibrium; for a closed "
           "path, the energy that is created in one cycle",
           work_.sum)
      .has_either_sign();
  s.metric(
      "law_unbalanced_steps", "1",
      "number of steps without an equilibrium of the law: in every pose that was found, the forces of hand and law "
      "differ by more than 1e-3 N",
      unbalanced_);
  s.metric("reference_residual_max_N", "N",
           "largest residual of the conditions of optimality of the 6-DOF device, over the steps with an equilibrium",
           residual_);
  s.metric("reference_jumps", "1", "number of steps in which the tool of the 6-DOF device jumps to another equilibrium",
           jumps_);
  s.metric("reference_unsolved_steps", "1",
           "number of steps without an equilibrium of the 6-DOF device: the tool does not fit, or the search does not "
           "converge",
           unsolved_);
}

}  // namespace hapbench
