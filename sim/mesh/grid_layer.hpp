#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/mesh/node_grid.hpp"

namespace hapbench {

/// One layer of the nodes of a grid, of equal z: which nodes are inside, which of the edges that start in them the
/// surface crosses, and the numbers of the vertices there. A bit a node: word w of row j has the nodes (64 w …, j).
class GridLayer {
 public:
  /// The edges that start in the nodes of a word and are crossed, a bit each. Their vertices are numbered node by node,
  /// those along x and y together (x first), those along z apart.
  struct Edges {
    std::uint64_t x, y, z;
    std::uint32_t first_in_layer, first_along_z;
  };

  /// Field and grid must outlive the layer.
  GridLayer(const DensityField& field, const NodeGrid& grid);

  /// Forgets the layer it was and finds what is inside in layer k, and the crossed edges along x and y. Returns
  /// their number. Cost: a few evaluations for each node next to the surface, and a few word operations for every 64
  /// nodes.
  std::size_t evaluate(std::size_t k);
  /// Finds the crossed edges along z, to the layer above. Returns their number.
  std::size_t cross_to(const GridLayer& above);

  std::size_t words() const { return words_; }
  std::uint64_t inside(std::size_t w, std::size_t j) const { return inside_[j * words_ + w]; }
  /// The same of the nodes after them along x.
  std::uint64_t next_inside(std::size_t w, std::size_t j) const {
    return inside(w, j) >> 1u | (w + 1 < words_ ? inside(w + 1, j) << 63u : 0);
  }
  /// The nodes of word w from which an edge along x starts: all but the row's last.
  std::uint64_t starting(std::size_t w) const { return w + 1 < words_ ? ~std::uint64_t{0} : starting_in_last_; }

  /// Positive inside. Evaluated when first asked for.
  double density(std::size_t i, std::size_t j);

  Edges& edges(std::size_t w, std::size_t j) { return edges_[j * words_ + w]; }
  /// Number of the vertex on the crossed edge from the node along an axis.
  std::uint32_t vertex(std::size_t i, std::size_t j, std::size_t axis) const {
    const Edges& edges = edges_[j * words_ + i / 64];
    const std::uint64_t below = (std::uint64_t{1} << i % 64) - 1;
    const auto count = [](std::uint64_t bits) { return static_cast<std::uint32_t>(std::popcount(bits)); };
    if (axis == 2) return edges.first_along_z + count(edges.z & below);
    const bool along_x = axis == 1 && (edges.x >> i % 64 & 1u) != 0;
    return edges.first_in_layer + count(edges.x & below) + count(edges.y & below) + along_x;
  }

 private:
  double set_density(std::size_t i, std::size_t j, double distance);
  void find_inside(std::size_t i, std::size_t j, std::size_t size);

  const DensityField& field_;
  const NodeGrid& grid_;
  std::size_t words_, k_ = 0;
  std::uint64_t starting_in_last_;
  std::vector<std::uint64_t> inside_, known_;
  std::vector<Edges> edges_;
  std::unique_ptr<double[]> density_;  ///< of the known nodes
};

}  // namespace hapbench
