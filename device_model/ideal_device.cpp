#include "device_model/ideal_device.hpp"

#include "device_model/input_force_limiter.hpp"

namespace hapbench {

IdealDevice::IdealDevice(std::optional<double> force_limit) : force_limit_(force_limit) {}

void IdealDevice::reset(const ToolState& tool) noexcept {
  handle_ = {tool.pose.position, tool.velocity};
}

MeasuredForce IdealDevice::measure(const Vec3& hand_force) noexcept {
  return {hand_force, force_limit_ ? limit_input_force(hand_force, *force_limit_) : hand_force};
}

void IdealDevice::advance(const ToolState& tool, const Vec3&, double) noexcept {
  handle_ = {tool.pose.position, tool.velocity};
}

}  // namespace hapbench
