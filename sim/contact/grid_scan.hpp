#pragma once

#include <span>
#include <vector>

#include "sim/contact/grid_index.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The points of a grid in a box, as runs of packs that a tool is asked about with one call, in memory that lasts from
/// search to search.
class GridScan {
 public:
  /// Allocates for the largest box. The grid must outlive the scan.
  explicit GridScan(const GridIndex& grid);
  GridScan(const GridScan&) = delete;
  GridScan& operator=(const GridScan&) = delete;

  /// Lists the points in the cells that meet the box; returns how many there are.
  std::size_t select(const Box& box) noexcept;

  /// What a ToolShape is asked about, and where its marks go.
  PointArrays points() const noexcept { return {grid_->x(), grid_->y(), grid_->z()}; }
  std::span<const PackRange> packs() const noexcept { return {packs_.data(), runs_}; }
  std::uint8_t* marks() noexcept { return marks_.data(); }

  /// True if some point is marked.
  bool any_hit() const;
  /// Calls `take(hits, i)` where some of the eight points from i on are marked, in ascending order of the grid.
  template <class Take>
  void for_each_hit(Take take) const {
    const std::uint8_t* marks = marks_.data();
    for (const PackRange& run : packs()) {
      for (std::size_t pack = run.first; pack < run.last; ++pack) {
        if (const std::uint8_t hits = *marks++; hits != 0) take(hits, pack * simd::lanes);
      }
    }
  }

 private:
  const GridIndex* grid_;
  std::size_t runs_ = 0;
  std::vector<PackRange> packs_;
  std::vector<std::uint8_t> marks_;
};

}  // namespace hapbench
