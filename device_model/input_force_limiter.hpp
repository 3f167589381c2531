#pragma once

#include "sim/core/types.hpp"

namespace hapbench {

/// Input force limiting (thesis 2.7, C.4.4): scales the measured force [N] down to the limit if its norm exceeds it.
/// Once the hand pushes harder than the limit, the virtual tool penetrates no further, which feels infinitely stiff.
inline Vec3 limit_input_force(const Vec3& measured, double limit) noexcept {
  const double length = measured.norm();
  return length <= limit ? measured : Vec3(measured * (limit / length));
}

}  // namespace hapbench
