#pragma once

#include "sim/loop/device.hpp"

namespace hapbench {

/// The moving parts of the device: a carriage driven by the actuators and, connected to it by an elastic structure, the
/// handle. The thesis gives none of these values; the handle's weight is what it compensates (0.7 N).
struct HandleMechanicsConfig {
  double carriage_mass = 0.25;  ///< [kg]
  double handle_mass = 0.07;    ///< [kg]
  double friction = 2.0;        ///< viscous, on the carriage [N s/m]
  double structure_stiffness =
      200000.0;                     ///< between carriage and handle; the structure's compliance is its inverse [N/m]
  double structure_damping = 40.0;  ///< [N s/m]

  bool operator==(const HandleMechanicsConfig&) const = default;
};

/// Two masses connected by a spring and a damper, independently in each axis, integrated by the implicit midpoint rule,
/// which is stable for every step size and, for this linear system, conserves the energy balance exactly. Gravity is
/// assumed to be compensated.
class HandleMechanics {
 public:
  explicit HandleMechanics(const HandleMechanicsConfig& config) : config_(config) {}

  /// Places carriage and handle at the tool, with the tool's velocity and the structure unstretched.
  void reset(const ToolState& tool) noexcept;
  /// One step of dt seconds under constant forces of the hand (on the handle) and the actuators (on the carriage) [N].
  void advance(const Vec3& hand, const Vec3& actuator, double dt) noexcept;

  const HandleState& carriage() const noexcept { return carriage_; }
  const HandleState& handle() const noexcept { return handle_; }
  DeviceEnergy energy() const noexcept;

 private:
  double stored() const noexcept;

  HandleMechanicsConfig config_;
  HandleState carriage_;
  HandleState handle_;
  DeviceEnergy work_;  ///< its `stored` is not kept up
  double stored_at_reset_ = 0.0;
};

}  // namespace hapbench
