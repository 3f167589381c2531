#pragma once

#include <optional>

#include "scenarios/studies/worst_motion/trajectory.hpp"
#include "sim/core/random.hpp"

namespace hapbench {

/// The trajectories a search may try: all within the bounds, all beginning with the same orientation, all with numbers
/// that are short to write (1 ms, 0.1 mrad, 1 mN).
class TrajectoryDraws {
 public:
  /// Planar: no azimuth, no force along z. `tilt`, `azimuth`: of the beginning [rad]; a tilt beyond the bounds is let
  /// be until the first waypoint after it.
  TrajectoryDraws(const TrajectoryBounds& bounds, bool planar, double tilt, double azimuth)
      : bounds_(bounds), planar_(planar), tilt_(tilt), azimuth_(azimuth) {}

  /// No motion and no force.
  Trajectory at_rest() const;
  Trajectory random(Random& random) const;
  /// One to three numbers of `from` moved by about `step` of their ranges.
  Trajectory changed(Trajectory from, double step, Random& random) const;

  /// How many ways to simplify a trajectory there are: an end cut off, a waypoint left out, a number made zero.
  std::size_t simplifications(const Trajectory& trajectory) const;
  /// The i-th of them; none when it would change nothing.
  std::optional<Trajectory> simplified(const Trajectory& trajectory, std::size_t i) const;

 private:
  Trajectory within_bounds(Trajectory trajectory) const;

  TrajectoryBounds bounds_;
  bool planar_;
  double tilt_, azimuth_;
};

}  // namespace hapbench
