#pragma once

#include <array>
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

}  // namespace hapbench
