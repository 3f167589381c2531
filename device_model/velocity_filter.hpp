#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <variant>
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

/// v_k = (x_k - x_(k-1)) / T.
struct DifferenceFilter {};

/// First-order adaptive windowing, the end-fit of F. Janabi-Sharifi, V. Hayward and C.-S. J. Chen, "Discrete-time
/// adaptive windowing for velocity estimation", IEEE Transactions on Control Systems Technology 8(6), 2000: the slope
/// (x_k - x_(k-n)) / (n T), each axis on its own. The window n is the longest for which every sample within it, and
/// within all shorter windows, is no further than the noise from the straight line through its ends.
struct AdaptiveWindowFilter {
  double noise = 1e-5;  ///< largest error of a sample [m]; half the encoder's step for a rounded position
  /// The longest window [samples] (ours). It reduces the effect of an encoder's step to a fifteenth of that on the
  /// difference and lags by half its length, 7.5 ms at 1 kHz.
  static constexpr std::size_t kLongest = 15;
};

/// With LowPassFilter: the continuous low-pass of the difference d_k held over its period, for order 1
/// v_k = v_(k-1) + (1 - e^(-2 pi f T)) (d_k - v_(k-1)).
using VelocityFilterConfig = std::variant<DifferenceFilter, LowPassFilter, AdaptiveWindowFilter>;

/// Estimates a controller's velocity from sampled positions. Allocates in the constructor only.
class VelocityFilter {
 public:
  /// dt: sampling period T [s].
  VelocityFilter(const VelocityFilterConfig& config, double dt);

  /// Starts with the sample `position` [m] and the velocity zero.
  void reset(const Vec3& position) noexcept;
  /// Takes the next sample [m] and returns the velocity there [m/s].
  Vec3 read(const Vec3& position) noexcept;

 private:
  double end_fit(Eigen::Index axis, double noise) const noexcept;
  /// The sample `ago` periods before the last one.
  const Vec3& sample(std::size_t ago) const noexcept {
    return samples_[(next_ + samples_.size() - 1 - ago) % samples_.size()];
  }

  VelocityFilterConfig config_;
  double dt_;
  std::optional<SampledLowPass> low_pass_;
  std::array<Vec3, AdaptiveWindowFilter::kLongest + 1> samples_{};  ///< ring
  std::size_t next_ = 0;                                            ///< index of the next sample
  std::size_t known_ = 0;  ///< samples since the reset, at most the size of the ring
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace hapbench
