#pragma once

#include <optional>

#include "sim/loop/device.hpp"

namespace hapbench {

/// Input force limiting (thesis 2.7, C.4.4): scales the measured force [N] down to the limit if its norm exceeds it.
/// Once the hand pushes harder than the limit, the virtual tool penetrates no further, which feels infinitely stiff.
inline Vec3 limit_input_force(const Vec3& measured, double limit) noexcept {
  const double length = measured.norm();
  return length <= limit ? measured : Vec3(measured * (limit / length));
}

/// A device without dynamics: it measures the force of the hand exactly, and its handle is the tool.
class IdealDevice final : public Device {
 public:
  /// force_limit: threshold f_th of the input-force limiter [N]; none: no limit.
  explicit IdealDevice(std::optional<double> force_limit) : force_limit_(force_limit) {}

  void reset(const ToolState& tool) noexcept override { handle_ = {tool.pose.position, tool.velocity}; }
  MeasuredForce measure(const Vec3& hand_force) noexcept override {
    return {hand_force, force_limit_ ? limit_input_force(hand_force, *force_limit_) : hand_force};
  }
  void advance(const ToolState& tool, const Vec3&, double) noexcept override { reset(tool); }
  HandleState handle() const noexcept override { return handle_; }

 private:
  std::optional<double> force_limit_;
  HandleState handle_;
};

}  // namespace hapbench
