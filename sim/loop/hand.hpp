#pragma once

#include "sim/core/types.hpp"

namespace hapbench {

/// The handle the hand holds; the same as the tool for an ideal device.
struct HandleState {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};

/// The human hand: what it pushes with, given time and what the handle does.
class Hand {
 public:
  virtual ~Hand() = default;
  virtual void reset() noexcept = 0;
  /// Force of the hand on the handle at time t [N].
  virtual Vec3 force(double t, const HandleState& handle) noexcept = 0;
};

}  // namespace hapbench
