#pragma once

#include "sim/core/types.hpp"

namespace hapbench {

/// Input force limiting (thesis 2.7, C.4.4): the measured force [N] scaled down to the limit when it is longer. With it
/// the virtual tool stops sinking in once the hand pushes harder than the limit, which feels infinitely stiff.
inline Vec3 limit_input_force(const Vec3& measured, double limit) noexcept {
  const double length = measured.norm();
  return length <= limit ? measured : Vec3(measured * (limit / length));
}

}  // namespace hapbench
