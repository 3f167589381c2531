#pragma once

#include <cmath>

#include "sim/core/types.hpp"

namespace hapbench {

/// Every component as the nearest multiple of `step`, halves away from zero; `v` itself for the step 0.
inline Vec3 rounded_to(const Vec3& v, double step) noexcept {
  if (step == 0.0) return v;
  return {std::round(v.x() / step) * step, std::round(v.y() / step) * step, std::round(v.z() / step) * step};
}

}  // namespace hapbench
