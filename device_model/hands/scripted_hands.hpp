#pragma once

#include <array>
#include <optional>
#include <utility>

#include "device_model/hands/tremor.hpp"
#include "sim/core/math.hpp"
#include "sim/core/profile.hpp"
#include "sim/loop/hand.hpp"

namespace hapbench {

/// A hand without force: nobody holds the handle.
class NoHand final : public Hand {
 public:
  void reset() noexcept override {}
  Vec3 force(double, const HandView&) noexcept override { return Vec3::Zero(); }
};

/// A hand that pushes with a scripted force, independent of the handle's motion.
class ForceHand final : public Hand {
 public:
  /// Components x, y, z in the world frame [N] over time.
  explicit ForceHand(std::array<Profile, 3> force) : force_(std::move(force)) {}

  void reset() noexcept override {}
  Vec3 force(double t, const HandView&) noexcept override { return {force_[0](t), force_[1](t), force_[2](t)}; }

 private:
  std::array<Profile, 3> force_;
};

/// A hand that pushes with a scripted force in one direction.
class PushHand final : public Hand {
 public:
  /// `direction` is a unit vector in the world frame, `force` its multiple over time [N].
  PushHand(Profile force, const Vec3& direction) : force_(std::move(force)), direction_(direction) {}

  void reset() noexcept override {}
  Vec3 force(double t, const HandView&) noexcept override { return force_(t) * direction_; }

 private:
  Profile force_;
  Vec3 direction_;
};

/// A hand that holds the handle towards a scripted target like a spring and a damper:
/// f = k (x_target - x_handle) + b (v_target - v_handle). A tremor moves the target.
class ImpedanceHand final : public Hand {
 public:
  /// Stiffness [N/m], damping [N s/m], and the target's x, y, z [m] over time.
  ImpedanceHand(double stiffness, double damping, std::array<Profile, 3> target, std::optional<Tremor> tremor = {})
      : stiffness_(stiffness), damping_(damping), target_(std::move(target)), tremor_(std::move(tremor)) {}

  void reset() noexcept override {}
  Vec3 force(double t, const HandView& view) noexcept override {
    Vec3 position{target_[0](t), target_[1](t), target_[2](t)};
    Vec3 velocity{target_[0].rate(t), target_[1].rate(t), target_[2].rate(t)};
    if (tremor_) {
      const Tremor::State moved = tremor_->at(t);
      position += moved.position;
      velocity += moved.velocity;
    }
    return stiffness_ * (position - view.handle.position) + damping_ * (velocity - view.handle.velocity);
  }

 private:
  double stiffness_;
  double damping_;
  std::array<Profile, 3> target_;
  std::optional<Tremor> tremor_;
};

/// Unit vector at `angle` [rad] from -z, towards +x turned by `azimuth` [rad] about z. Exactly -z at angle 0.
inline Vec3 push_direction(double angle, double azimuth) {
  return {math::sin(angle) * math::cos(azimuth), math::sin(angle) * math::sin(azimuth), -math::cos(angle)};
}

}  // namespace hapbench
