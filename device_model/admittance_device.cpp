#include "device_model/admittance_device.hpp"

namespace hapbench {

void HandleMechanics::reset(const ToolState& tool) noexcept {
  carriage_ = handle_ = {tool.pose.position, tool.velocity};
  work_ = {.stored = -stored()};
}

// Midpoint velocities w solve, with the stretch s = x_c - x_h and a = k dt / 2 + c,
//
//   (2 m_c / dt + b + a) w_c - a w_h = u - k s + 2 m_c / dt v_c
//   -a w_c + (2 m_h / dt + a) w_h    = f + k s + 2 m_h / dt v_h
//
// in each axis. Then x += w dt and v = 2 w - v.
void HandleMechanics::advance(const Vec3& hand, const Vec3& actuator, double dt) noexcept {
  const double inertia_c = 2.0 * config_.carriage_mass / dt, inertia_h = 2.0 * config_.handle_mass / dt;
  const double a = config_.structure_stiffness * dt / 2.0 + config_.structure_damping;
  const double cc = inertia_c + config_.friction + a, hh = inertia_h + a;
  const double determinant = cc * hh - a * a;  // positive: a sum of products of positive terms
  const Vec3 tension = config_.structure_stiffness * (carriage_.position - handle_.position);
  const Vec3 right_c = actuator - tension + inertia_c * carriage_.velocity;
  const Vec3 right_h = hand + tension + inertia_h * handle_.velocity;
  const Vec3 w_c = (hh * right_c + a * right_h) / determinant;
  const Vec3 w_h = (a * right_c + cc * right_h) / determinant;

  carriage_ = {carriage_.position + w_c * dt, 2.0 * w_c - carriage_.velocity};
  handle_ = {handle_.position + w_h * dt, 2.0 * w_h - handle_.velocity};
  work_.hand += hand.dot(w_h) * dt;
  work_.actuator += actuator.dot(w_c) * dt;
  work_.dissipated -=
      (config_.friction * w_c.squaredNorm() + config_.structure_damping * (w_c - w_h).squaredNorm()) * dt;
}

double HandleMechanics::stored() const noexcept {
  return 0.5 * config_.carriage_mass * carriage_.velocity.squaredNorm() +
         0.5 * config_.handle_mass * handle_.velocity.squaredNorm() +
         0.5 * config_.structure_stiffness * (carriage_.position - handle_.position).squaredNorm();
}

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
