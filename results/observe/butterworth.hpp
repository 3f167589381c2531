#pragma once

#include <array>

#include "sim/core/types.hpp"

namespace hapbench {

/// A Butterworth high pass of fourth order for a sampled vector signal, component by component: two biquads, from the
/// analogue prototype by the bilinear transform with the cutoff prewarped. Its gain is exactly 1/2 (-3 dB) at the
/// cutoff: |H(f)|^2 = 1 / (1 + (tan(pi fc / fs) / tan(pi f / fs))^8), 0 at f = 0 and 1 at half the sampling rate fs.
class HighPass {
 public:
  /// Cutoff and sampling rate [Hz]. Precondition: 0 < cutoff < sampling_rate / 2.
  HighPass(double cutoff, double sampling_rate);

  /// Filters one sample.
  Vec3 filter(const Vec3& sample) noexcept;
  /// Sets the state to that of a constant past input `value`: the output is exactly zero until the input changes.
  void settle_at(const Vec3& value) noexcept;

 private:
  /// y = b0 (1 - 2 z^-1 + z^-2) / (1 + a1 z^-1 + a2 z^-2) x, transposed direct form II.
  struct Biquad {
    double b0 = 0.0, a1 = 0.0, a2 = 0.0;
    Vec3 s1 = Vec3::Zero(), s2 = Vec3::Zero();
  };
  std::array<Biquad, 2> biquads_;
};

}  // namespace hapbench
