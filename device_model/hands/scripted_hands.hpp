#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "sim/core/profile.hpp"
#include "sim/loop/hand.hpp"

namespace hapbench {

/// Zero force: nobody holds the handle.
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

/// Unit vector at `angle` from straight down, -z, towards +x turned by `azimuth` about z [rad]. Exactly -z at angle 0.
inline Vec3 push_direction(double angle, double azimuth) {
  return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), -std::cos(angle)};
}

}  // namespace hapbench
