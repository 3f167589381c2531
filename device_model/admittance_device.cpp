#include "device_model/admittance_device.hpp"

#include "device_model/input_force_limiter.hpp"

namespace hapbench {

AdmittanceDevice::AdmittanceDevice(const AdmittanceDeviceConfig& config)
    : force_limit_(config.force_limit), sensor_(config.sensor), servo_(config.servo), mechanics_(config.mechanics) {}

void AdmittanceDevice::reset(const ToolState& tool) noexcept {
  sensor_.reset();
  servo_.reset();
  mechanics_.reset(tool);
}

MeasuredForce AdmittanceDevice::measure(const Vec3& hand_force) noexcept {
  const Vec3 measured = sensor_.read(hand_force);
  const Vec3 input = sensor_.compensated(measured);
  return {measured, force_limit_ ? limit_input_force(input, *force_limit_) : input};
}

void AdmittanceDevice::advance(const ToolState& tool, const Vec3& hand_force, double dt) noexcept {
  const HandleState& carriage = mechanics_.carriage();
  const Vec3 actuator = servo_.force(tool, carriage.position, carriage.velocity);
  mechanics_.advance(hand_force, actuator, dt);
}

}  // namespace hapbench
