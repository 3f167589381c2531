#pragma once

/// Largest sizes of a scenario. Larger requests, which may exceed every integer, are refused before they take memory.
namespace hapbench {

inline constexpr double kMostPoints = 2e7;  ///< shell points or springs of an environment
inline constexpr double kMostSteps = 1e9;   ///< steps of a run
inline constexpr double kMostRows = 2e7;    ///< rows that a run may record

inline constexpr double kFarthestPoint = 1000.0;  ///< largest coordinate of a point of a surface's file [m]

}  // namespace hapbench
