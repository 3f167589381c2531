#include "device_model/admittance_device.hpp"

namespace hapbench {

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

void AdmittanceDevice::reset(const ToolState& tool) noexcept {
  sensor_.reset();
  servo_.reset();
  mechanics_.reset(tool);
}

MeasuredForce AdmittanceDevice::measure(const Vec3& hand_force) noexcept {
  const Vec3 measured = sensor_.read(hand_force);
  return {measured, limit_input_force(sensor_.compensated(measured), force_limit_)};
}

void AdmittanceDevice::advance(const ToolState& tool, const Vec3& hand_force, double dt) noexcept {
  const HandleState& carriage = mechanics_.carriage();
  mechanics_.advance(hand_force, servo_.force(tool, carriage.position, carriage.velocity), dt);
}

}  // namespace hapbench
