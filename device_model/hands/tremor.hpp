#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

namespace hapbench {

/// How a hand that means to rest moves. Physiological tremor has its power at 8 to 12 Hz (T. Novak, K. M. Newell,
/// Neuroscience Letters 641, 2017); a finger's amplitude is about 30 um with the arm at rest, twice that with the hand
/// and four to five times with the arm held out (W. Growdon et al., Electromyogr. Clin. Neurophysiol. 40(5), 2000).
struct TremorConfig {
  Vec3 rms = {30e-6, 30e-6, 30e-6};  ///< of each axis [m]
  double low = 8.0, high = 12.0;     ///< band [Hz]

  static constexpr std::size_t kTones = 8;
  /// Speed that the displacement of an axis never exceeds [m/s]: that of all its tones together.
  double largest_speed() const { return std::sqrt(2.0 * kTones) * 2.0 * std::numbers::pi * high * rms.maxCoeff(); }
};

/// A displacement in that band: tones with random frequency and phase, one in each of equal parts of the band, so that
/// it is the same function of time for every time step.
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

  /// Displacement [m] and velocity [m/s] at a time [s].
  struct State {
    Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
  };
  State at(double t) const noexcept {
    State state;
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
  static constexpr std::size_t kTones = TremorConfig::kTones;
  struct Tone {
    double amplitude, rate, phase;  ///< [m], [rad/s], [rad]
  };
  std::array<std::array<Tone, kTones>, 3> tones_;
};

}  // namespace hapbench
