#pragma once

#include <optional>

#include "sim/task/target_task.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// The handle held by the hand; the same as the tool for an ideal device.
struct HandleState {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};

/// The user's perception in one step, the handle in the hand and what the display shows: the simulation's own numbers.
struct HandView {
  const HandleState& handle;
  const ToolPose& tool;      ///< on the display
  const Vec3& model_force;   ///< f_render of the previous step, for gauge and task [N]
  const Vec3& spring_force;  ///< f_spring of the previous step, for gauge and task [N]
};

/// Model of the human hand: its force on the handle as a function of time and perception.
class Hand {
 public:
  virtual ~Hand() = default;
  virtual void reset() noexcept {}
  /// Force of the hand on the handle at time t [N]. Called once a step.
  virtual Vec3 force(double t, const HandView& view) noexcept = 0;
  /// The target task of the hand, or null. Lives as long as the hand.
  virtual const TargetTask* task() const noexcept { return nullptr; }
  /// True once the hand's task is finished; the run ends with that row.
  bool finished() const noexcept { return task() != nullptr && task()->finished(); }
};

/// The hand's force in one step, as the device measures and limits it [N].
struct MeasuredForce {
  Vec3 measured = Vec3::Zero();  ///< f_meas: reading of the sensor
  Vec3 input = Vec3::Zero();     ///< f_meas*: drives the virtual mass, after the limiter; 0 without such a mass
};

/// Energy balance of a device's moving parts since its last reset [J]. Up to rounding, stored = hand + actuator +
/// dissipated.
struct DeviceEnergy {
  double hand = 0.0;        ///< work of the hand on the handle
  double actuator = 0.0;    ///< work of the actuator
  double dissipated = 0.0;  ///< work of friction and of the damping in the structure; never positive
  double stored = 0.0;      ///< kinetic and elastic energy of the parts, above that at the reset

  DeviceEnergy plus_stored(double energy) const noexcept { return {hand, actuator, dissipated, stored + energy}; }
};

/// The haptic device. Either it measures the hand's force and moves the handle after the tool, which is a virtual mass,
/// or its handle moves the tool (`moves_tool`) and there is no virtual mass.
class Device {
 public:
  virtual ~Device() = default;
  /// Returns to t = 0 with the handle on the tool.
  virtual void reset(const ToolState& tool) noexcept = 0;
  virtual MeasuredForce measure(const Vec3& hand_force) noexcept = 0;
  /// Follows the tool's motion over one step of dt seconds, while the hand pushes on the handle.
  virtual void advance(const ToolState& /*tool*/, const Vec3& /*hand_force*/, double /*dt*/) noexcept {}
  virtual const HandleState& handle() const noexcept = 0;
  /// Returns nothing if the handle is the tool itself and has no mass or friction of its own.
  virtual std::optional<DeviceEnergy> energy() const noexcept { return std::nullopt; }

  /// True if the handle moves the tool. `drive` then replaces the integrator and `advance`.
  virtual bool moves_tool() const noexcept { return false; }
  /// Moves on from row k to row k + 1, with f_render and the hand's force of row k [N].
  virtual void drive(const Vec3& /*rendered*/, const Vec3& /*hand_force*/) noexcept {}
  /// Position and velocity of the handle as measured by such a device; those of the tool.
  virtual HandleState sampled() const noexcept { return handle(); }
};

}  // namespace hapbench
