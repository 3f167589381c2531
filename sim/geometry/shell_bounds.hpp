#pragma once

#include "sim/core/box.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// The box around the points of a shell; the origin for a shell without. O(n).
Box bounds_of(const PointShell& shell);

}  // namespace hapbench
