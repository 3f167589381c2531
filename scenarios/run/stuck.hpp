#pragma once

namespace hapbench {

/// A tool counts as standing still while it moves by less than this fraction of the distance by which the hand's target
/// moves.
inline constexpr double kMinMovingFraction = 0.1;

/// A standstill that lasted to the end of the run, while the target of the tool's hand moved on.
struct Stuck {
  double since = 0.0;                                 ///< start of the standstill [s]
  double tool_distance = 0.0, target_distance = 0.0;  ///< distances that tool and target have moved since then [m]
};

}  // namespace hapbench
