#pragma once

#include "sim/core/types.hpp"

namespace hapbench {

/// An axis-aligned box in the world frame [m]. Empty when min > max.
struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
};

/// How far a point lies from a box that is not empty [m]; 0 in it.
inline double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

}  // namespace hapbench
