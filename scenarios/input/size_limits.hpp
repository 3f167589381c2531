#pragma once

/// Maximum sizes of a scenario. Larger requests are rejected before memory is allocated. The limits have type
/// double, because a requested size may exceed the range of every integer type.
namespace hapbench {

inline constexpr double kMaxSurfacePoints = 2e7;  ///< maximum number of surface points or springs of an environment
inline constexpr double kMaxSteps = 1e9;          ///< maximum number of time steps of a run
inline constexpr double kMaxRows = 2e7;           ///< maximum number of time steps that a run records

inline constexpr double kMaxCoordinate = 1000.0;  ///< maximum absolute coordinate of a point in a surface file [m]

}  // namespace hapbench
