#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// What lies between a rendered force and the motors.
struct ForcePathConfig {
  double step = 0.0;           ///< resolution: every component is the nearest multiple of this [N]; 0: exact
  std::optional<double> max;   ///< the motors saturate at this norm [N]
  std::optional<double> slew;  ///< fastest change of the force, by its norm [N/s]
  double delay_samples = 0.0;  ///< from the sample to the force, whole and fractional [periods]
};

/// The force of the motors over one period: `before` for `switch_part` of it, `after` for the rest. `switch_part` is
/// the fraction of the delay, 0 without one.
struct HeldForce {
  Vec3 before = Vec3::Zero();  ///< [N]
  Vec3 after = Vec3::Zero();   ///< [N]
};

/// Resolution, saturation and slew limit, in this order, then a delay line and a zero-order hold. Allocates in the
/// constructor only.
class ForcePath {
 public:
  /// dt: period T [s].
  ForcePath(const ForcePathConfig& config, double dt);

  /// Back to zero force, everywhere on the way.
  void reset() noexcept;
  /// Takes the force rendered at the beginning of a period [N] and returns what the motors do during it.
  HeldForce hold(const Vec3& rendered) noexcept;
  /// Part of a period after which the motors change their force, in [0, 1).
  double switch_part() const noexcept { return switch_part_; }

 private:
  Vec3 command(const Vec3& rendered) const noexcept;

  ForcePathConfig config_;
  double largest_change_ = 0.0;  ///< from period to period, if the slew is limited [N]
  double switch_part_;
  Vec3 last_ = Vec3::Zero();    ///< command of the period before
  std::vector<Vec3> commands_;  ///< ring: of this period and those that are still to come or just ending
  std::size_t next_ = 0;
};

}  // namespace hapbench
