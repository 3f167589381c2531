#pragma once

#include "sim/core/types.hpp"

namespace hapbench {

/// An axis-aligned box in the world frame [m]. Empty when min > max.
struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
};

}  // namespace hapbench
