#include "device_model/impedance_device.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

Vec3 rounded_to(const Vec3& v, double step) noexcept {
  if (step == 0.0) return v;
  return {std::round(v.x() / step) * step, std::round(v.y() / step) * step, std::round(v.z() / step) * step};
}

// The ring holds the commands of this period, of the whole periods of the delay, and one more for a fraction of it.
ForcePath::ForcePath(const ImpedanceDeviceConfig& config, double dt)
    : step_(config.force_step),
      max_(config.force_max),
      slew_(config.force_slew),
      largest_change_(config.force_slew.value_or(0.0) * dt),
      switch_part_(config.delay_samples - std::floor(config.delay_samples)),
      commands_(static_cast<std::size_t>(config.delay_samples) + 2, Vec3::Zero()) {}

void ForcePath::reset() noexcept {
  std::fill(commands_.begin(), commands_.end(), Vec3::Zero());
  next_ = 0;
  last_.setZero();
}

HeldForce ForcePath::hold(const Vec3& rendered) noexcept {
  last_ = commands_[next_] = command(rendered);
  next_ = (next_ + 1) % commands_.size();
  return {commands_[next_], commands_[(next_ + 1) % commands_.size()]};
}

Vec3 ForcePath::command(const Vec3& rendered) const noexcept {
  Vec3 force = rounded_to(rendered, step_);
  if (max_) {
    if (const double norm = force.norm(); norm > *max_) force *= *max_ / norm;
  }
  if (slew_) {
    const Vec3 change = force - last_;
    if (const double norm = change.norm(); norm > largest_change_) force = last_ + change * (largest_change_ / norm);
  }
  return force;
}

ImpedanceDevice::ImpedanceDevice(const ImpedanceDeviceConfig& config, double dt, const AttachedHand& hand)
    : encoder_step_(config.encoder_step),
      filter_(config.velocity_filter, dt),
      noise_(config.position_noise),
      seed_(config.seed),
      random_(config.seed),
      path_(config, dt),
      motion_(config, hand),
      before_(free_motion(motion_.law(), path_.switch_part() * dt)),
      after_(free_motion(motion_.law(), (1.0 - path_.switch_part()) * dt)) {
  if (config.position_filter) position_filter_.emplace(*config.position_filter, dt);
  if (config.transmission) {
    const ElasticMotion motion(config, *config.transmission, hand);
    elastic_.emplace(Elastic{motion, motion.stretch(before_.time), motion.stretch(after_.time)});
  }
}

void ImpedanceDevice::reset(const ToolState& tool) noexcept {
  motion_.reset({tool.pose.position, tool.velocity});
  if (elastic_) elastic_->motion.reset({tool.pose.position, tool.velocity});
  path_.reset();
  if (noise_ > 0.0) random_ = Random(seed_);
  sampled_ = {read_position(), Vec3::Zero()};
  filter_.reset(sampled_.position);
  if (position_filter_) position_filter_->settle_at(sampled_.position);
}

Vec3 ImpedanceDevice::read_position() noexcept {
  Vec3 position = elastic_ ? elastic_->motion.motor().position : motion_.handle().position;
  if (noise_ > 0.0)
    for (double& axis : position) axis += noise_ * random_.normal();
  return rounded_to(position, encoder_step_);
}

void ImpedanceDevice::drive(const Vec3& rendered, const Vec3& hand_force) noexcept {
  const HeldForce motors = path_.hold(rendered);
  const auto advance = [&](auto& motion, const auto& before, const auto& after) {
    motion.take_hand(hand_force);
    if (before_.time > 0.0) motion.advance(motors.before, before);
    motion.advance(motors.after, after);
  };
  elastic_ ? advance(elastic_->motion, elastic_->before, elastic_->after) : advance(motion_, before_, after_);
  sampled_.position = read_position();
  sampled_.velocity = filter_.read(sampled_.position);
  if (position_filter_) sampled_.position = position_filter_->filter(sampled_.position);
}

}  // namespace hapbench
