#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "sim/core/math.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Seeded random numbers that are identical with every standard library. The C++ standard specifies the output of
/// the engine std::mt19937_64, but not the output of its distributions, so the distributions are implemented here.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Returns the seed with index `number` of the seed sequence `stream`. Sequences of neighbouring `stream` values
  /// lie far apart.
  static constexpr std::uint64_t derive(std::uint64_t stream, std::uint64_t number) {
    return stream * 0x9e3779b97f4a7c15 + number;  // 2^64 / golden ratio
  }

  /// Returns a uniform number in [0, 1) with 53 random bits.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  /// Returns a uniform number in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Returns a uniform integer in [0, n). Precondition: n > 0. The modulo bias is below n / 2^64.
  std::uint64_t below(std::uint64_t n) { return engine_() % n; }
  /// Returns a normally distributed number with mean 0 and standard deviation 1 (Box-Muller). Discards the second
  /// number of each Box-Muller pair, so that the result does not depend on whether the number of earlier calls is odd
  /// or even.
  double normal() {
    const double r = std::sqrt(-2.0 * math::log(1.0 - uniform()));
    return r * math::cos(2.0 * std::numbers::pi * uniform());
  }

  /// Shuffles the items in place (Fisher-Yates).
  template <class T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(i)]);
  }

  /// Returns a unit vector in the plane z = 0, uniform on the circle.
  Vec3 direction_in_plane() {
    const auto [sine, cosine] = math::sine_cosine(2.0 * std::numbers::pi * uniform());
    return {cosine, sine, 0.0};
  }
  /// Returns a unit vector, uniform on the sphere.
  Vec3 direction() {
    const double z = uniform(-1.0, 1.0);
    const auto [sine, cosine] = math::sine_cosine(2.0 * std::numbers::pi * uniform());
    const double r = std::sqrt(1.0 - z * z);
    return {r * cosine, r * sine, z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace hapbench
