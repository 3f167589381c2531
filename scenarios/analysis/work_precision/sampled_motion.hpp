#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "results/summary/outcome.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/simulation.hpp"

/// Samples the motion and the force of a run in every TimeFields::stride-th step. Two runs with different time steps
/// are sampled at the same times if the product of time step and stride is equal in both runs. They can then be
/// compared sample by sample.
namespace hapbench {

/// Tip position and rendered force of a run in every n-th step, n = TimeFields::stride.
struct SampledMotion {
  std::vector<Vec3> position;  ///< position of the tip centre [m]
  std::vector<Vec3> force;     ///< rendered force [N]
  Ending ending = Ending::completed;
  Outcome outcome = Outcome::completes;
};

/// Runs the first trial of a scenario and samples every TimeFields::stride-th step. `shift`: displacement [m] of the
/// starting position of a tool whose position is free. Throws InputError and Stopped.
SampledMotion sampled_motion(const CheckedScenario& checked, const Vec3& shift = Vec3::Zero());

/// Difference of two motions: root mean square, over all samples, of the distance between the vectors that both motions
/// have in a sample.
struct MotionDifference {
  double position = 0.0;  ///< [m]
  double force = 0.0;     ///< [N]
};
/// Returns the difference of two motions; nothing if there are no samples, or if the motions differ in their number of
/// samples or their ending.
std::optional<MotionDifference> difference(const SampledMotion& a, const SampledMotion& b);

}  // namespace hapbench
