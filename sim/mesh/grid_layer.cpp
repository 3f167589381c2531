#include "sim/mesh/grid_layer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapbench {

GridLayer::GridLayer(const DensityField& field, const NodeGrid& grid)
    : field_(field),
      grid_(grid),
      words_((grid.count(0) + 63) / 64),
      starting_in_last_((std::uint64_t{1} << (grid.count(0) - 1) % 64) - 1),
      inside_(words_ * grid.count(1)),
      known_(words_ * grid.count(1)),
      edges_(words_ * grid.count(1)),
      density_(std::make_unique_for_overwrite<double[]>(64 * words_ * grid.count(1))) {}

double GridLayer::set_density(std::size_t i, std::size_t j, double distance) {
  known_[j * words_ + i / 64] |= std::uint64_t{1} << i % 64;
  return density_[j * 64 * words_ + i] =
             field_.density == Density::signed_distance ? -distance : (distance < 0.0 ? 0.5 : -0.5);
}

double GridLayer::density(std::size_t i, std::size_t j) {
  if ((known_[j * words_ + i / 64] >> i % 64 & 1u) != 0) return density_[j * 64 * words_ + i];
  return set_density(i, j, field_.signed_distance(grid_.node(i, j, k_)));
}

/// The nodes of the square of `size` x `size` from (i, j), which lies in one word of each row.
void GridLayer::find_inside(std::size_t i, std::size_t j, std::size_t size) {
  const double half = 0.5 * grid_.spacing() * static_cast<double>(size - 1);
  const double distance = field_.signed_distance(grid_.node(i, j, k_) + Vec3(half, half, 0.0));
  // A distance falls by no more than the way: without the surface nearer than its corners, the square is all inside or
  // all outside. 1e-9 of slack for the rounding of the distance.
  if (size > 1 && std::abs(distance) <= std::numbers::sqrt2 * half * (1.0 + 1e-9)) {
    for (const std::size_t y : {j, j + size / 2}) {
      for (const std::size_t x : {i, i + size / 2}) {
        if (x < grid_.count(0) && y < grid_.count(1)) find_inside(x, y, size / 2);
      }
    }
    return;
  }
  if (size == 1) set_density(i, j, distance);
  if (!(distance < 0.0)) return;
  const std::uint64_t bits = (size < 64 ? (std::uint64_t{1} << size) - 1 : ~std::uint64_t{0}) << i % 64;
  for (std::size_t y = j; y < std::min(j + size, grid_.count(1)); ++y) inside_[y * words_ + i / 64] |= bits;
}

std::size_t GridLayer::evaluate(std::size_t k) {
  k_ = k;
  std::fill(inside_.begin(), inside_.end(), 0);
  std::fill(known_.begin(), known_.end(), 0);
  for (std::size_t j = 0; j < grid_.count(1); j += 64) {
    for (std::size_t i = 0; i < grid_.count(0); i += 64) find_inside(i, j, 64);
  }
  std::size_t count = 0;
  for (std::size_t j = 0; j < grid_.count(1); ++j) {
    for (std::size_t w = 0; w < words_; ++w) {
      Edges& crossed = edges(w, j);
      crossed.x = (inside(w, j) ^ next_inside(w, j)) & starting(w);
      crossed.y = j + 1 < grid_.count(1) ? inside(w, j) ^ inside(w, j + 1) : 0;
      count += static_cast<std::size_t>(std::popcount(crossed.x) + std::popcount(crossed.y));
    }
  }
  return count;
}

std::size_t GridLayer::cross_to(const GridLayer& above) {
  std::size_t count = 0;
  for (std::size_t word = 0; word < edges_.size(); ++word) {
    edges_[word].z = inside_[word] ^ above.inside_[word];
    count += static_cast<std::size_t>(std::popcount(edges_[word].z));
  }
  return count;
}

}  // namespace hapbench
