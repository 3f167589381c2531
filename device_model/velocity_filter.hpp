#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <variant>

#include "device_model/low_pass.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

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
