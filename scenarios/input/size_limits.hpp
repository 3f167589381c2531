#pragma once

/// Sizes beyond which memory or disk would be absurd for a bench: refused, not attempted. Doubles, because what is
/// asked for may be beyond every integer.
namespace hapbench {

inline constexpr double kMostPoints = 2e7;  ///< shell points or springs of an environment
inline constexpr double kMostSteps = 1e9;   ///< of a run
inline constexpr double kMostRows = 2e7;    ///< a run may record

}  // namespace hapbench
