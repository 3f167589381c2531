#include "device_model/impedance_device.hpp"

#include "device_model/resolution.hpp"

namespace hapbench {

ImpedanceDevice::ImpedanceDevice(const ImpedanceDeviceConfig& config, double dt, const AttachedHand& hand)
    : encoder_step_(config.encoder_step),
      filter_(config.velocity_filter, dt),
      path_({config.force_step, config.force_max, config.force_slew, config.delay_samples}, dt),
      motion_({config.handle_mass, config.viscous, config.coulomb}, hand),
      before_(free_motion(motion_.law(), path_.switch_part() * dt)),
      after_(free_motion(motion_.law(), (1.0 - path_.switch_part()) * dt)) {}

void ImpedanceDevice::reset(const ToolState& tool) noexcept {
  motion_.reset({tool.pose.position, tool.velocity});
  path_.reset();
  sampled_ = {rounded_to(tool.pose.position, encoder_step_), Vec3::Zero()};
  filter_.reset(sampled_.position);
}

void ImpedanceDevice::drive(const Vec3& rendered, const Vec3& hand_force) noexcept {
  const HeldForce motors = path_.hold(rendered);
  motion_.take_hand(hand_force);
  if (before_.time > 0.0) motion_.advance(motors.before, before_);
  motion_.advance(motors.after, after_);
  sampled_.position = rounded_to(motion_.handle().position, encoder_step_);
  sampled_.velocity = filter_.read(sampled_.position);
}

}  // namespace hapbench
