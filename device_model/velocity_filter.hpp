#pragma once

#include <array>
#include <cstddef>
#include <variant>

#include "sim/core/types.hpp"

namespace hapbench {

/// v_k = (x_k - x_(k-1)) / T.
struct DifferenceFilter {};

/// The difference through a first-order low-pass, v_k = v_(k-1) + (1 - e^(-2 pi f T)) (d_k - v_(k-1)): what the
/// continuous low-pass makes of d_k held over the period.
struct LowPassFilter {
  double cutoff = 100.0;  ///< f [Hz], where the continuous low-pass has half the power
};

/// First-order adaptive windowing, the end-fit of F. Janabi-Sharifi, V. Hayward and C.-S. J. Chen, "Discrete-time
/// adaptive windowing for velocity estimation", IEEE Transactions on Control Systems Technology 8(6), 2000: the slope
/// (x_k - x_(k-n)) / (n T), each axis on its own. The window n grows from 1 as long as every sample within it lies no
/// further than the noise from the straight line through its ends, and ends at the first that does not.
struct AdaptiveWindowFilter {
  double noise = 1e-5;  ///< largest error of a sample [m]; half the encoder's step for a rounded position
  /// The longest window [samples] (ours). It takes an encoder's step down to a fifteenth of what the difference makes
  /// of it, and lags by half its length, 7.5 ms at 1 kHz; a longer one would lag more than it calms.
  static constexpr std::size_t kLongest = 15;
};

using VelocityFilterConfig = std::variant<DifferenceFilter, LowPassFilter, AdaptiveWindowFilter>;

/// The velocity that a controller makes of sampled positions. Allocates nothing.
class VelocityFilter {
 public:
  /// dt: time from sample to sample, T [s].
  VelocityFilter(const VelocityFilterConfig& config, double dt);

  /// Starts with the sample `position` [m] and the velocity zero.
  void reset(const Vec3& position) noexcept;
  /// Takes the next sample [m] and returns the velocity there [m/s].
  Vec3 read(const Vec3& position) noexcept;

 private:
  double end_fit(Eigen::Index axis, double noise) const noexcept;
  /// The sample of so many periods ago.
  const Vec3& sample(std::size_t ago) const noexcept {
    return samples_[(next_ + samples_.size() - 1 - ago) % samples_.size()];
  }

  VelocityFilterConfig config_;
  double dt_;
  double taken_ = 1.0;                                              ///< of a new difference, by the low-pass
  std::array<Vec3, AdaptiveWindowFilter::kLongest + 1> samples_{};  ///< ring
  std::size_t next_ = 0;                                            ///< where the next sample goes
  std::size_t known_ = 0;  ///< samples since the reset, as far as the ring reaches
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace hapbench
