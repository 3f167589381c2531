#pragma once

#include <string>

#include "sim/core/types.hpp"

/// Ranges and checks that several descriptions of fields share.
namespace hapbench {

/// Range of the lengths in a scene.
inline constexpr NumberRange kLength = {0.0, 1000.0, "m", true};
/// Shortest length of a direction: the square of a much shorter one would lose digits.
inline constexpr double kShortestDirection = 1e-12;

/// Throws InputError at the JSON pointer `at` when the direction is shorter than kShortestDirection.
void require_direction(const Vec3& direction, const std::string& at);
/// Throws InputError at the JSON pointer `at` when the count of `what` is larger than `most`.
void require_at_most(double most, double count, const std::string& at, const char* what);

}  // namespace hapbench
