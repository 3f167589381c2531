#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include "sim/core/types.hpp"

namespace hapbench {

/// Returns the parts concatenated to one text; numbers have six significant digits.
template <class... Parts>
std::string joined(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Returns the three coordinates, separated by commas.
inline std::string coordinates(const Vec3& point) {
  return joined(point.x(), ", ", point.y(), ", ", point.z());
}

/// Throws std::invalid_argument; the message is the concatenated parts.
template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  throw std::invalid_argument(joined(parts...));
}

}  // namespace hapbench
