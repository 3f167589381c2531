#pragma once

#include <string>

#include "sim/core/types.hpp"

/// Quantities as people read them.
namespace hapbench {

/// A length as people read it, with three significant digits and the unit that fits, as in "13.5 mm" or "17.5 m".
std::string length_text(double metres);

/// The edges of a box in one unit, as in "13.5 x 16.7 x 6.6 mm".
std::string size_text(const Box& box);
/// The place of a box in one unit, as in "x -6.74 ... 6.76, y -7.3 ... 9.4, z -3.3 ... 3.3 mm".
std::string place_text(const Box& box);

}  // namespace hapbench
