#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include "sim/core/types.hpp"

namespace hapbench {

/// The parts in a row, numbers with six digits.
template <class... Parts>
std::string joined(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

inline std::string coordinates(const Vec3& place) {
  return joined(place.x(), ", ", place.y(), ", ", place.z());
}

/// Throws std::invalid_argument with the joined parts.
template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  throw std::invalid_argument(joined(parts...));
}

}  // namespace hapbench
