#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// A continuous Butterworth low-pass, |H(f)|^2 = 1 / (1 + (f / cutoff)^(2 order)).
struct LowPassFilter {
  double cutoff = 100.0;              ///< half-power frequency [Hz]
  std::size_t order = 1;              ///< 1 to kHighest
  static constexpr int kHighest = 8;  ///< order; rounding of its sum of modes is below 1e-12 of the input
};

/// A term of the partial fractions of a low-pass, sampled: y += taken (share u - y) for each sample u, which is exact
/// for a u held over the period before. The output is the sum of the real parts of the terms.
struct LowPassMode {
  std::complex<double> share, taken;  ///< of a pair of poles, one with twice its share; real for a real pole

  /// The term's transfer function at z = e^(j theta).
  std::complex<double> response(double theta) const;
};

/// The terms of a low-pass for samples at intervals of `dt` [s]; one for order 1.
std::vector<LowPassMode> low_pass_modes(const LowPassFilter& filter, double dt);

/// A low-pass of sampled vectors. Allocates in the constructor only; a sample takes about 5 ns a mode.
class SampledLowPass {
 public:
  SampledLowPass(const LowPassFilter& filter, double dt);

  /// Sets the state to that of a constant past input.
  void settle_at(const Vec3& value) noexcept;
  Vec3 filter(const Vec3& sample) noexcept;

 private:
  struct Term {
    LowPassMode mode;
    Vec3 real = Vec3::Zero(), imaginary = Vec3::Zero();
  };
  std::vector<Term> terms_;
  bool passes_all_ = true;  ///< the cut-off is so high that nothing is remembered
};

}  // namespace hapbench
