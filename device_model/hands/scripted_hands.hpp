#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "sim/core/math.hpp"
#include "sim/core/random.hpp"
#include "sim/loop/device.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// Involuntary motion of a hand that tries to rest. Physiological tremor has its power at 8 to 12 Hz (T. Novak, K.
/// M. Newell, Neuroscience Letters 641, 2017). A finger's amplitude is about 30 um with the arm at rest, twice as
/// large with the hand held out, and four to five times as large with the arm held out (W. Growdon et al.,
/// Electromyogr. Clin. Neurophysiol. 40(5), 2000).
struct TremorConfig {
  Vec3 rms = {30e-6, 30e-6, 30e-6};  ///< root mean square of the displacement in each axis [m]
  double low = 8.0, high = 12.0;     ///< frequency band [Hz]
};

/// Random displacement within a frequency band: a sum of tones with random frequency and phase, with one tone in each
/// of kTones equal parts of the band. The displacement depends only on the time t, and not on the time step of the run.
class Tremor {
 public:
  Tremor(const TremorConfig& config, std::uint64_t seed) {
    Random random(seed);
    const double width = (config.high - config.low) / kTones;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < kTones; ++i) {
        const double from = config.low + width * static_cast<double>(i);
        tones_[static_cast<std::size_t>(axis)][i] = {config.rms[axis] * std::sqrt(2.0 / kTones),
                                                     2.0 * std::numbers::pi * random.uniform(from, from + width),
                                                     2.0 * std::numbers::pi * random.uniform()};
      }
    }
  }

  /// Returns displacement [m] and velocity [m/s] at time t [s].
  HandleState at(double t) const noexcept {
    HandleState state;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      for (const auto& [amplitude, rate, phase] : tones_[static_cast<std::size_t>(axis)]) {
        if (amplitude == 0.0) break;
        const auto [sine, cosine] = math::sine_cosine(rate * t + phase);
        state.position[axis] += amplitude * sine;
        state.velocity[axis] += amplitude * rate * cosine;
      }
    }
    return state;
  }

 private:
  static constexpr std::size_t kTones = 8;
  struct Tone {
    double amplitude, rate, phase;  ///< [m], [rad/s], [rad]
  };
  std::array<std::array<Tone, kTones>, 3> tones_;
};

/// A hand that pushes with a scripted force, independent of the handle's motion.
class ForceHand final : public Hand {
 public:
  /// `force`: components x, y, z in the world frame [N] over time. Empty profiles: no hand holds the handle.
  explicit ForceHand(std::array<Profile, 3> force = {}) : force_(std::move(force)) {}

  Vec3 force(double t, const HandView&) noexcept override { return vector_at(force_, t); }

 private:
  std::array<Profile, 3> force_;
};

/// A hand that pushes with a scripted force in one direction.
class PushHand final : public Hand {
 public:
  /// `direction`: unit vector in the world frame. `force`: signed force along `direction` over time [N].
  PushHand(Profile force, const Vec3& direction) : force_(std::move(force)), direction_(direction) {}

  Vec3 force(double t, const HandView&) noexcept override { return force_(t) * direction_; }

 private:
  Profile force_;
  Vec3 direction_;
};

/// A hand that pulls the handle towards a scripted target with a spring and a damper: f = k (x_target - x_handle) +
/// b (v_target - v_handle). A tremor displaces the target.
class ImpedanceHand final : public Hand {
 public:
  /// `stiffness`: k [N/m]. `damping`: b [N s/m]. `target`: x, y, z of the target over time [m].
  ImpedanceHand(double stiffness, double damping, std::array<Profile, 3> target, std::optional<Tremor> tremor = {})
      : stiffness_(stiffness), damping_(damping), target_(std::move(target)), tremor_(tremor) {}

  Vec3 force(double t, const HandView& view) noexcept override {
    Vec3 position = vector_at(target_, t);
    Vec3 velocity{target_[0].rate(t), target_[1].rate(t), target_[2].rate(t)};
    if (tremor_) {
      const HandleState moved = tremor_->at(t);
      position += moved.position;
      velocity += moved.velocity;
    }
    return stiffness_ * (position - view.handle.position) + damping_ * (velocity - view.handle.velocity);
  }
  HandImpedance impedance() const noexcept override {
    return {stiffness_ * Mat3::Identity(), damping_ * Mat3::Identity()};
  }

 private:
  double stiffness_;
  double damping_;
  std::array<Profile, 3> target_;
  std::optional<Tremor> tremor_;
};

/// Returns the unit vector at `angle` [rad] from -z, tilted towards the direction that results if +x is rotated by
/// `azimuth` [rad] about z. Exactly -z at angle 0.
inline Vec3 push_direction(double angle, double azimuth) {
  return {math::sin(angle) * math::cos(azimuth), math::sin(angle) * math::sin(azimuth), -math::cos(angle)};
}

}  // namespace hapbench
