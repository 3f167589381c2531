#include "sim/contact/grid_scan.hpp"

#include <algorithm>

namespace hapbench {

/// A run of n points meets at most n / 8 + 2 packs.
GridScan::GridScan(const GridIndex& grid)
    : grid_(&grid), packs_(grid.columns()), marks_(grid.size() / simd::lanes + 2 * grid.columns()) {}

std::size_t GridScan::select(const Box& box) noexcept {
  std::size_t points = 0;
  runs_ = 0;
  grid_->for_each_run(box, [&](std::uint32_t first, std::uint32_t last) {
    const std::size_t end = (last + simd::lanes - 1) / simd::lanes;
    // Whole packs: the first and the last one may reach into neighbouring columns.
    packs_[runs_++] = {first / simd::lanes, end, static_cast<std::uint8_t>(0xffu << first % simd::lanes),
                       static_cast<std::uint8_t>(0xffu >> (end * simd::lanes - last))};
    points += last - first;
  });
  return points;
}

bool GridScan::any_hit() const {
  std::size_t packs = 0;
  for (const PackRange& run : this->packs()) packs += run.last - run.first;
  return std::any_of(marks_.begin(), marks_.begin() + static_cast<std::ptrdiff_t>(packs),
                     [](std::uint8_t hits) { return hits != 0; });
}

}  // namespace hapbench
