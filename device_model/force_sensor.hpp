#pragma once

#include <cstdint>

#include "sim/core/random.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Errors that the force sensor adds to the hand's force (thesis 3.5; the noise is our addition).
struct ForceSensorConfig {
  double weight = 0.7;           ///< of the dummy drill, read along `down` [N]
  Vec3 down = {0.0, 0.0, -1.0};  ///< unit
  bool compensated = true;       ///< the weight is taken off before the limiter
  double noise = 0.0;            ///< standard deviation of every component in every sample [N]
  std::uint64_t seed = 1;        ///< of the noise

  bool operator==(const ForceSensorConfig&) const = default;
};

/// The force sensor under the handle: f_meas = f_hand + weight + noise.
///
/// The thesis logs f_meas including the weight, and its limit of 2 N acts at 2.7 N of the logged force (3.5, Fig. 6),
/// so the weight must be subtracted before the force drives the virtual mass. `compensated = false` skips the
/// subtraction, as 2.7 reads literally: then the weight pulls the virtual tool down, and the limit acts at 2 N of
/// f_meas.
class ForceSensor {
 public:
  explicit ForceSensor(const ForceSensorConfig& config) : config_(config), random_(config.seed) {}

  void reset() noexcept { random_ = Random(config_.seed); }

  /// f_meas of the next sample [N].
  Vec3 read(const Vec3& hand_force) noexcept {
    Vec3 force = hand_force + config_.weight * config_.down;
    if (config_.noise > 0.0) {
      for (double& component : force) component += config_.noise * random_.normal();
    }
    return force;
  }

  /// The part of a reading that drives the virtual mass, before the limiter [N].
  Vec3 compensated(const Vec3& measured) const noexcept {
    return config_.compensated ? Vec3(measured - config_.weight * config_.down) : measured;
  }

 private:
  ForceSensorConfig config_;
  Random random_;
};

}  // namespace hapbench
