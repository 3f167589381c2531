#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {

/// The nodes around the box of a density field, numbered from 0 along each axis; cells lie between them.
class NodeGrid {
 public:
  explicit NodeGrid(const DensityField& field);

  std::size_t count(std::size_t axis) const { return count_[axis]; }
  std::size_t nodes_in_layer() const { return count_[0] * count_[1]; }
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

/// One layer of the nodes of a grid, of equal z: the density where the surface may be near, and the vertices on the
/// edges that start in it. Node (i, j) has the number j * count(0) + i. Lasts from layer to layer, since it is as large
/// as the grid is wide and most of it is empty.
class GridLayer {
 public:
  explicit GridLayer(const NodeGrid& grid);

  /// Forgets the layer it was and evaluates layer k. Cost: the nodes near the surface, and a few in every row.
  void evaluate(const DensityField& field, const NodeGrid& grid, std::size_t k);

  /// The nodes that may be corners of cut cells, ascending; every corner of a cut cell is among them.
  const std::vector<std::uint32_t>& near() const { return near_; }
  /// Positive inside; NaN for nodes that are not near.
  double density(std::size_t node) const { return density_[node]; }

  /// Number of the vertex on the edge from the node along an axis: to be set before it is read.
  std::uint32_t& on_edge(std::size_t node, std::size_t axis) { return on_edge_[3 * node + axis]; }

 private:
  std::vector<double> density_;
  std::vector<std::uint32_t> near_;
  std::unique_ptr<std::uint32_t[]> on_edge_;
};

}  // namespace hapbench
