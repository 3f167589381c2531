#include "sim/mesh/node_grid.hpp"

#include <cmath>

namespace hapbench {

NodeGrid::NodeGrid(const DensityField& field) : spacing_(field.spacing) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    // A cell to spare on each side, so that the surface cuts no cell at the border.
    first_[axis] = static_cast<std::int64_t>(std::floor(field.min[a] / spacing_)) - 1;
    const auto last = static_cast<std::int64_t>(std::ceil(field.max[a] / spacing_)) + 2;
    count_[axis] = static_cast<std::size_t>(last - first_[axis] + 1);
  }
}

}  // namespace hapbench
