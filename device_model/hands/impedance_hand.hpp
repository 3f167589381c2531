#pragma once

#include <array>
#include <utility>

#include "sim/core/profile.hpp"
#include "sim/loop/hand.hpp"

namespace hapbench {

/// A hand that holds the handle towards a scripted target like a spring and a damper:
/// f = k (x_target - x_handle) + b (v_target - v_handle).
class ImpedanceHand final : public Hand {
 public:
  /// Stiffness [N/m], damping [N s/m], target x, y, z [m] over time.
  ImpedanceHand(double stiffness, double damping, std::array<Profile, 3> target)
      : stiffness_(stiffness), damping_(damping), target_(std::move(target)) {}

  void reset() noexcept override {}
  Vec3 force(double t, const HandView& view) noexcept override {
    const Vec3 position{target_[0](t), target_[1](t), target_[2](t)};
    const Vec3 velocity{target_[0].rate(t), target_[1].rate(t), target_[2].rate(t)};
    return stiffness_ * (position - view.handle.position) + damping_ * (velocity - view.handle.velocity);
  }

 private:
  double stiffness_;
  double damping_;
  std::array<Profile, 3> target_;
};

}  // namespace hapbench
