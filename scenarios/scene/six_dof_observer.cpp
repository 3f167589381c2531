#include "scenarios/scene/six_dof_observer.hpp"

#include "algorithms/proxy/turning_proxy.hpp"
#include "algorithms/six_dof/turns.hpp"

namespace hapbench {
namespace {

/// Returns the rendering settings of the law on the 3-DOF device (SixDofFields::law).
RenderingConfig rendering_of(const Scenario& scenario, const six_dof::HandAndCoupling& springs) {
  const std::string& law = scenario.six_dof->law;
  if (law.empty()) return scenario.rendering;
  if (law != kMatchedProxy) return with_algorithm(scenario, law).rendering;
  RenderingConfig config = with_algorithm(scenario, "proxy").rendering;
  config.parameters["proxy"][kRotationalStiffness] = springs.matched_rotation();
  return config;
}

/// Returns the pose that the hand intends, computed from the scripted pose `pose`. A rotation of the tool moves the tip
/// about the pivot, in addition to the scripted motion of the tip. `first_axis` is the tool's axis in the script at
/// t = 0.
six_dof::Intent intent_of(const SixDofFields& fields, const ToolPose& pose, const Vec3& first_axis) noexcept {
  six_dof::Intent intent;
  intent.orientation = Eigen::Quaterniond(pose.rotation()).normalized();
  const Vec3 tip = pose.position + fields.pivot * (pose.axis - first_axis);
  intent.grip = tip + (fields.grip - fields.force_point) * pose.axis;
  return intent;
}

}  // namespace

void SixDofObserver::begin(const TrialParts& trial) {
  const SixDofFields& fields = *scenario_->six_dof;
  const six_dof::HandAndCoupling springs = {.coupling = scenario_->rendering.stiffness,
                                            .coupling_rotation = fields.coupling_rotation,
                                            .hand = fields.hand,
                                            .hand_rotation = fields.hand_rotation,
                                            .force_point = fields.force_point,
                                            .grip = fields.grip};
  const PointShell& shell = *trial.simulation.shell;
  const ToolShape& tool = *trial.simulation.tool;
  reference_.emplace(shell, tool, springs, scenario_->rendering.skips);
  device_.emplace(shell, tool, springs, rendering_of(*scenario_, springs), trial.config.dt);
  first_axis_ = trial.simulation.motion->axis_at(0.0);
  metrics_ = {};
}

void SixDofObserver::on_step(const StepRecord& record) noexcept {
  const six_dof::Intent intent = intent_of(*scenario_->six_dof, record.tool.pose, first_axis_);
  row_ = {};
  // Find the equilibrium of the 6-DOF device.
  const auto step = reference_->follow(intent);
  const six_dof::Handle& with_torque = reference_->handle();
  row_.jumped = step.jumped;
  if (step.solved) {
    row_.residual = step.residual;
    const ToolPose tool = reference_->tool_pose();
    row_.reference = {.force = with_torque.force,
                      .torque = with_torque.torque,
                      .position = with_torque.position,
                      .tip = tool.position,
                      .axis = tool.axis,
                      .handle_turn = six_dof::turn_between(intent.orientation, with_torque.orientation)};
  }
  // Find the equilibrium of the 3-DOF device.
  if (device_->follow(intent) <= six_dof::kBalanced) {
    const six_dof::Handle& handle = device_->handle();
    row_.law = {.force = handle.force,
                .position = handle.position,
                .turn = six_dof::turn_between(with_torque.orientation, handle.orientation).norm()};
  }
  metrics_.add(row_);
}

}  // namespace hapbench
