#pragma once

#include "sim/loop/hand.hpp"
#include "sim/tool/tool.hpp"

namespace hapbench {

/// What the device makes of the hand's force in one step [N].
struct MeasuredForce {
  Vec3 measured = Vec3::Zero();  ///< f_meas: what the sensor reads
  Vec3 input = Vec3::Zero();     ///< f_meas*: what drives the virtual mass, after the input-force limiter
};

/// The haptic device in the admittance loop: it measures the hand's force and moves the handle after the tool.
class Device {
 public:
  virtual ~Device() = default;
  /// Back to t = 0 with the handle on the tool.
  virtual void reset(const ToolState& tool) noexcept = 0;
  virtual MeasuredForce measure(const Vec3& hand_force) noexcept = 0;
  /// Follows the tool's motion over one step of dt seconds, while the hand pushes on the handle.
  virtual void advance(const ToolState& tool, const Vec3& hand_force, double dt) noexcept = 0;
  virtual HandleState handle() const noexcept = 0;
};

}  // namespace hapbench
