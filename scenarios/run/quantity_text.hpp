#pragma once

#include <string>

#include "sim/core/types.hpp"

/// Formats lengths, positions and boxes for messages.
namespace hapbench {

/// Returns a length with three significant digits and a fitting unit, such as "13.5 mm" or "17.5 m".
std::string length_text(double metres);

/// Returns a position with three significant digits, such as "(1.2, -0.345, 0) mm".
std::string position_text(const Vec3& position);

/// Returns the edge lengths of a box in one unit, such as "13.5 x 16.7 x 6.6 mm".
std::string size_text(const Box& box);
/// Returns the coordinate ranges of a box in one unit, such as "x -6.74 ... 6.76, y -7.3 ... 9.4, z -3.3 ...
/// 3.3 mm".
std::string bounds_text(const Box& box);

}  // namespace hapbench
