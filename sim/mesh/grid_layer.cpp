#include "sim/mesh/grid_layer.hpp"

#include <cmath>
#include <limits>
#include <numbers>

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

GridLayer::GridLayer(const NodeGrid& grid)
    : density_(grid.nodes_in_layer(), std::numeric_limits<double>::quiet_NaN()),
      on_edge_(std::make_unique_for_overwrite<std::uint32_t[]>(3 * grid.nodes_in_layer())) {}

void GridLayer::evaluate(const DensityField& field, const NodeGrid& grid, std::size_t k) {
  for (const std::uint32_t node : near_) density_[node] = std::numeric_limits<double>::quiet_NaN();
  near_.clear();
  // A cut cell has the surface on one of its edges, no further from any corner than the cell's diagonal. 1e-9 of slack
  // for the rounding of the distance.
  const double reach = std::numbers::sqrt3 * grid.spacing() * (1.0 + 1e-9);
  std::size_t row = 0;
  for (std::size_t j = 0; j < grid.count(1); ++j, row += grid.count(0)) {
    Vec3 point = grid.node(0, j, k);
    for (std::size_t i = 0; i < grid.count(0);) {
      point.x() = grid.coordinate(i, 0);
      const double distance = field.signed_distance(point);
      const double beyond = std::abs(distance) - reach;
      if (beyond > 0.0) {
        // A distance falls by no more than the way: the nodes between are beyond reach, too.
        const double steps = std::ceil(beyond / grid.spacing());
        i += steps < static_cast<double>(grid.count(0)) ? static_cast<std::size_t>(steps) : grid.count(0);
        continue;
      }
      const std::size_t node = row + i++;
      near_.push_back(static_cast<std::uint32_t>(node));
      density_[node] = field.density == Density::signed_distance ? -distance : (distance < 0.0 ? 0.5 : -0.5);
    }
  }
}

}  // namespace hapbench
