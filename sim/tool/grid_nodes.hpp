#pragma once

#include <array>
#include <cstddef>

#include "sim/core/types.hpp"

namespace hapbench {

/// The nodes of a regular grid, those of a column along z one after the other.
struct GridNodes {
  Vec3 origin;     ///< node (0, 0, 0) [m]
  double spacing;  ///< [m]
  std::array<std::size_t, 3> count;

  std::size_t size() const noexcept { return count[0] * count[1] * count[2]; }
  std::size_t index(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return (i * count[1] + j) * count[2] + k;
  }
  double coordinate(int axis, std::size_t i) const noexcept { return origin[axis] + spacing * static_cast<double>(i); }
  Vec3 place(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return {coordinate(0, i), coordinate(1, j), coordinate(2, k)};
  }
};

}  // namespace hapbench
