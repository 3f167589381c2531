#pragma once

#include <string>

#include "sim/core/types.hpp"

/// Ranges and checks that are shared by several descriptions of fields.
namespace hapbench {

/// Allowed range of lengths in a scene: above 0, up to 1 km.
inline constexpr NumberRange kLength = {0.0, 1000.0, "m", true};
/// Minimum norm of a direction vector. The squared norm of a much shorter vector would lose digits.
inline constexpr double kMinDirectionNorm = 1e-12;

/// Throws InputError at the JSON pointer `at` if the direction is shorter than kMinDirectionNorm.
void require_direction(const Vec3& direction, const std::string& at);
/// Throws InputError at the JSON pointer `at` if `count` is larger than `max`. `what` names the counted items in
/// the message.
void require_at_most(double max, double count, const std::string& at, const char* what);

}  // namespace hapbench
