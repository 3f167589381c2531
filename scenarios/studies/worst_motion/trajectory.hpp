#pragma once

#include <cstddef>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// Where the hand turns the tool and pushes it at a time; between two of them by cosines, at rest in each.
struct Waypoint {
  double time = 0.0;          ///< [s]
  double tilt = 0.0;          ///< [rad]
  double azimuth = 0.0;       ///< [rad]; 0 in planar scenes
  Vec3 force = Vec3::Zero();  ///< [N]; in the plane in planar scenes
};
using Trajectory = std::vector<Waypoint>;

/// What a hand may do. Every motion lies within, however it was found.
struct TrajectoryBounds {
  double duration = 0.5;  ///< [s]
  std::size_t waypoints = 6;
  double tilt = 0.6;   ///< largest [rad]
  double rate = 2.0;   ///< largest mean rate of tilt and azimuth from one waypoint to the next [rad/s]
  double force = 5.0;  ///< largest norm [N]
};

}  // namespace hapbench
