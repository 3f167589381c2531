#pragma once

#include <optional>

#include "device_model/force_sensor.hpp"
#include "device_model/handle_mechanics.hpp"
#include "device_model/position_servo.hpp"
#include "sim/loop/device.hpp"

namespace hapbench {

struct AdmittanceDeviceConfig {
  ForceSensorConfig sensor;
  std::optional<double> force_limit = 2.0;  ///< f_th of the input-force limiter [N]; none switches it off
  PositionServoConfig servo;
  HandleMechanicsConfig mechanics;
};

/// The trainer's admittance-control device (thesis 2.7, 3.1, Fig. 3, C.5, C.6):
///
///   hand -> sensor -> limiter -> [ virtual mass ] -> position servo -> carriage -> structure -> handle -> hand
///
/// The virtual mass is the simulation's tool; the servo follows it one step behind the force that moved it.
class AdmittanceDevice final : public Device {
 public:
  explicit AdmittanceDevice(const AdmittanceDeviceConfig& config);

  void reset(const ToolState& tool) noexcept override;
  MeasuredForce measure(const Vec3& hand_force) noexcept override;
  void advance(const ToolState& tool, const Vec3& hand_force, double dt) noexcept override;
  HandleState handle() const noexcept override { return mechanics_.handle(); }
  std::optional<DeviceEnergy> energy() const noexcept override { return mechanics_.energy(); }

 private:
  std::optional<double> force_limit_;
  ForceSensor sensor_;
  PositionServo servo_;
  HandleMechanics mechanics_;
};

}  // namespace hapbench
