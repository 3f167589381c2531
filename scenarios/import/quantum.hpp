#pragma once

#include <optional>
#include <span>

namespace hapbench {

/// The step in which a recorded coordinate was kept: the greatest length of which all differences between its values
/// are multiples, as 1e-5 m of a log with five decimals. None when there is none above 1e-10 or above the rounding of
/// doubles (the coordinate was kept in full), or when all values are equal. O(n log n).
std::optional<double> quantum_of(std::span<const double> values);

}  // namespace hapbench
