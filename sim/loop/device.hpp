#pragma once

#include <optional>

#include "sim/task/target_task.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// State of the handle that the hand holds. On an ideal device the handle coincides with the tool.
struct HandleState {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};

/// Inputs of a hand model in one step: the exact simulated motion of the handle, the tool on the display, and the
/// forces of the previous step.
struct HandView {
  const HandleState& handle;
  const ToolPose& tool;      ///< tool as shown on the display
  const Vec3& model_force;   ///< f_render of the previous step [N], an input of the hand's target task
  const Vec3& spring_force;  ///< f_spring of the previous step [N], an input of the hand's target task
};

/// Linearisation of a hand's force for small motions of the handle: df = -stiffness dx - damping dv, with displacement
/// dx [m] and velocity change dv [m/s] of the handle.
struct HandImpedance {
  Mat3 stiffness = Mat3::Zero();  ///< [N/m]
  Mat3 damping = Mat3::Zero();    ///< [N s/m]
};

/// Model of the human hand: its force on the handle as a function of time and of what the person feels and sees
/// (HandView). One instance holds the state of one run.
class Hand {
 public:
  virtual ~Hand() = default;
  /// Resets the hand to its state at t = 0.
  virtual void reset() noexcept {}
  /// Returns the force of the hand on the handle at time t [N]. Called once in every step.
  virtual Vec3 force(double t, const HandView& view) noexcept = 0;
  /// Returns the linearisation of the force that force() returned last. Zero for a hand whose force does not depend on
  /// the handle.
  virtual HandImpedance impedance() const noexcept { return {}; }
  /// Returns the target task that the hand performs, or null. The task lives as long as the hand.
  virtual const TargetTask* task() const noexcept { return nullptr; }
  /// Returns true once the hand's task is finished. The run ends with that step.
  bool finished() const noexcept { return task() != nullptr && task()->finished(); }
};

/// The hand's force in one step, as measured and limited by the device [N].
struct MeasuredForce {
  Vec3 measured = Vec3::Zero();  ///< f_meas: reading of the force sensor
  Vec3 input = Vec3::Zero();     ///< f_meas*: limited reading that drives the virtual mass; 0 without a virtual mass
};

/// Energy balance of a device's moving parts since the last reset [J]. Up to rounding, stored = hand + actuator
/// + dissipated.
struct DeviceEnergy {
  double hand = 0.0;        ///< work done by the hand on the handle
  double actuator = 0.0;    ///< work done by the actuator
  double dissipated = 0.0;  ///< work done by friction and structural damping; never positive
  double stored = 0.0;      ///< kinetic and elastic energy of the parts, minus its value at the reset

  /// Returns the balance with `energy` [J] added to the stored energy.
  DeviceEnergy plus_stored(double energy) const noexcept { return {hand, actuator, dissipated, stored + energy}; }
};

/// The haptic device. There are two kinds. On an admittance-type device, the tool is a virtual mass: the device
/// measures the hand's force, and the handle follows the tool. On an impedance-type device (`moves_tool`), the
/// handle moves the tool, and there is no virtual mass.
class Device {
 public:
  virtual ~Device() = default;
  /// Resets the device to t = 0, with the handle at the position of the tool.
  virtual void reset(const ToolState& tool) noexcept = 0;
  /// Returns the hand's force [N] as measured in this step.
  virtual MeasuredForce measure(const Vec3& hand_force) noexcept = 0;
  /// Moves the handle over one step of dt [s], in which it follows the tool and the hand applies `hand_force` [N].
  virtual void advance(const ToolState& /*tool*/, const Vec3& /*hand_force*/, double /*dt*/) noexcept {}
  virtual const HandleState& handle() const noexcept = 0;
  /// Returns the energy balance; nullopt if the handle is the tool itself and has no mass or friction.
  virtual std::optional<DeviceEnergy> energy() const noexcept { return std::nullopt; }

  /// Returns true if the handle moves the tool. `drive` then replaces the integrator and `advance`.
  virtual bool moves_tool() const noexcept { return false; }
  /// Moves the handle from step k to step k + 1, under f_render and the hand's force of step k [N]. Called only
  /// if moves_tool().
  virtual void drive(const Vec3& /*rendered*/, const Vec3& /*hand_force*/) noexcept {}
  /// Returns position and velocity of the handle as measured by the device. They become the position and velocity of
  /// the tool. Called only if moves_tool().
  virtual HandleState sampled() const noexcept { return handle(); }
};

}  // namespace hapbench
