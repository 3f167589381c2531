#pragma once

#include <cstdint>

#include "sim/core/random.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// What the force sensor adds to the hand's force (thesis 3.5; the noise is ours).
struct ForceSensorConfig {
  double weight = 0.7;           ///< of the dummy drill, read along `down` [N]
  Vec3 down = {0.0, 0.0, -1.0};  ///< unit
  bool compensated = true;       ///< the weight is taken off before the limiter
  double noise = 0.0;            ///< standard deviation of every component in every sample [N]
  std::uint64_t seed = 1;        ///< of the noise
};

/// The force sensor under the handle: f_meas = f_hand + weight + noise.
///
/// The log holds f_meas with the weight, and the thesis's limit of 2 N takes hold at 2.7 N of it (3.5, Fig. 6), so what
/// drives the virtual mass has the weight taken off again. `compensated = false` leaves it on, as 2.7 reads literally:
/// then the weight pulls the virtual tool down, and the limit takes hold at 2 N of f_meas.
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

  /// What of a reading drives the virtual mass, before the limiter [N].
  Vec3 compensated(const Vec3& measured) const noexcept {
    return config_.compensated ? Vec3(measured - config_.weight * config_.down) : measured;
  }

 private:
  ForceSensorConfig config_;
  Random random_;
};

}  // namespace hapbench
