#pragma once

#include <array>
#include <cstdint>

#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {

/// The nodes around the box of a density field, numbered from 0 along each axis; cells lie between them.
class NodeGrid {
 public:
  explicit NodeGrid(const DensityField& field);

  std::size_t count(std::size_t axis) const { return count_[axis]; }
  double spacing() const { return spacing_; }
  /// [m]
  double coordinate(std::size_t i, std::size_t axis) const {
    return spacing_ * (static_cast<double>(first_[axis] + static_cast<std::int64_t>(i)) - 0.5);
  }
  Vec3 node(std::size_t i, std::size_t j, std::size_t k) const {
    return {coordinate(i, 0), coordinate(j, 1), coordinate(k, 2)};
  }

 private:
  double spacing_;
  std::array<std::int64_t, 3> first_;  ///< of the nodes, in units of the spacing from the node at -1/2
  std::array<std::size_t, 3> count_;
};

}  // namespace hapbench
