#pragma once

#include <cstddef>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// Parameters of the control loop that makes the carriage follow the virtual tool. The thesis gives the saturation
/// (C.4.4); the other values are our choice.
struct PositionServoConfig {
  double stiffness = 40000.0;  ///< force per position error [N/m]
  double damping = 160.0;      ///< force per velocity error [N s/m]
  double max_force = 30.0;     ///< the actuators saturate at this norm [N]
  std::size_t delay = 1;       ///< samples from the command to the force

  bool operator==(const PositionServoConfig&) const = default;
};

/// A proportional-derivative position servo with saturation and a delay of whole samples. Allocates in the constructor.
class PositionServo {
 public:
  explicit PositionServo(const PositionServoConfig& config)
      : config_(config), commands_(config.delay + 1, Vec3::Zero()) {}

  /// Clears the delay line: the servo starts from rest.
  void reset() noexcept {
    for (Vec3& command : commands_) command.setZero();
    next_ = 0;
  }

  /// Takes the command of this sample and returns the actuators' force during it [N].
  Vec3 force(const ToolState& reference, const Vec3& position, const Vec3& velocity) noexcept {
    Vec3 command =
        config_.stiffness * (reference.pose.position - position) + config_.damping * (reference.velocity - velocity);
    const double length = command.norm();
    if (length > config_.max_force) command *= config_.max_force / length;
    commands_[next_] = command;
    next_ = (next_ + 1) % commands_.size();
    return commands_[next_];  // the oldest command; without delay, the one just stored
  }

 private:
  PositionServoConfig config_;
  std::vector<Vec3> commands_;
  std::size_t next_ = 0;
};

}  // namespace hapbench
