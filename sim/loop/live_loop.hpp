#pragma once

#include <optional>

#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Computes forces step by step as a Simulation does, but without a script: in each step, the caller passes the
/// measured pose of the tool. For the same poses and velocities, the forces are bitwise equal to the forces of a
/// Simulation. Allocates in the constructor only.
class LiveLoop {
 public:
  /// The members hand, motion and device of `parts` are not used. `has_virtual_mass`: true if forces move the tool (see
  /// move()); false if the tool follows the measured handle. Throws the exceptions of ForceAlgorithm::prepare.
  LiveLoop(SimulationConfig config, SimulationParts parts, bool has_virtual_mass);
  // Not copyable, because the algorithm has pointers to members.
  LiveLoop(const LiveLoop&) = delete;
  LiveLoop& operator=(const LiveLoop&) = delete;

  /// Resets the loop to step 0.
  void reset() noexcept;
  /// Takes a step: computes the force on `tool`. `input` [N]: force that drives the virtual mass together with the
  /// rendered force; 0 without a virtual mass. Returns false if the position, the velocity or the rendered force is not
  /// finite or exceeds its bound (out_of_bounds()), or if a module failed (fault()).
  bool render(const ToolState& tool, const Vec3& input) noexcept;
  /// Moves the tool over one step with the scenario's integrator. `tool`: the state passed to the last render(). The
  /// force on the tool is the `input` of that render() plus `gain` times the rendered force. Does not change the
  /// orientation.
  void move(ToolState& tool, double gain) noexcept;

  const RenderedForce& force() const { return force_; }
  std::size_t contacts() const { return contacts_.size(); }
  /// Returns the moment of the last rendered contact forces about the tip centre [N m].
  Vec3 moment(const ToolState& tool) const noexcept;
  /// Returns the failure that a module reported, or null.
  const char* fault() const noexcept { return fault_; }
  /// Returns the quantity that exceeded its bound in the last `render`, or null.
  const char* out_of_bounds() const noexcept { return out_of_bounds_; }
  /// Returns the tool's angular velocity [rad/s] after a rotation from the pose `before` to `pose` in one step,
  /// low-pass filtered as in a Simulation. `last` [rad/s]: angular velocity of the previous step. Returns zero if the
  /// algorithm does not read the angular velocity. Precondition: both poses include their roll, also for a solid of
  /// revolution.
  Vec3 angular_velocity(const Vec3& last, const ToolPose& before, const ToolPose& pose) const noexcept;
  /// Returns true if the pose of the tool includes its roll.
  bool tool_rolls() const { return tool_rolls_; }
  bool needs_angular_velocity() const { return angular_velocity_cutoff_.has_value(); }
  double dt() const { return config_.dt; }

 private:
  class ForceWithinStep;

  SimulationConfig config_;
  SimulationParts parts_;
  ContactBuffer contacts_;
  RenderedForce force_, within_step_;
  std::uint64_t row_ = 0;       ///< number of the current step, for source and algorithm
  std::uint64_t next_row_ = 0;  ///< number of the next step
  Vec3 input_ = Vec3::Zero();   ///< input force of the current step [N]
  bool tool_rolls_;
  std::optional<double> angular_velocity_cutoff_;
  const char* fault_ = nullptr;
  const char* out_of_bounds_ = nullptr;
};

}  // namespace hapbench
