#pragma once

#include <optional>

#include "sim/loop/device.hpp"

namespace hapbench {

/// A device without dynamics: it measures the hand's force exactly and its handle is the tool.
class IdealDevice final : public Device {
 public:
  /// force_limit: threshold f_th of the input-force limiter [N]; none switches it off.
  explicit IdealDevice(std::optional<double> force_limit);

  void reset(const ToolState& tool) noexcept override;
  MeasuredForce measure(const Vec3& hand_force) noexcept override;
  void advance(const ToolState& tool, const Vec3& hand_force, double dt) noexcept override;
  HandleState handle() const noexcept override { return handle_; }

 private:
  std::optional<double> force_limit_;
  HandleState handle_;
};

}  // namespace hapbench
