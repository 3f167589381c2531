#include "sim/contact/grid_query.hpp"

#include <algorithm>
#include <cmath>

#include "sim/contact/shell_query.hpp"
#include "sim/contact/tool_box.hpp"
#include "sim/core/simd.hpp"
#include "sim/tool/axial.hpp"

namespace hapbench {

GridQuery::GridQuery(const PointShell& shell, const Tool& tool)
    : shell_(&shell),
      tool_(tool),
      radius2_(largest_square_within(tool.radius)),
      reach_(std::hypot(tool.length, tool.radius)),
      grid_(shell),
      found_(shell.size()) {}

void GridQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  collect(pose);
  if (!grid_.keeps_order()) std::sort(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(found_size_));
  for (std::size_t k = 0; k < found_size_; ++k) {
    const SurfacePoint point = shell_->point(found_[k]);
    contacts.push(found_[k], point.position, point.normal);
  }
}

/// Fills `found` with the points that touch the tool, in the order of the grid.
void GridQuery::collect(const ToolPose& pose) noexcept {
  // Far above the rounding of the box and of the test, far below a cell.
  const double margin = 1e-9 * reach_ + 1e-12 * (pose.position.cwiseAbs().maxCoeff() + reach_);
  const ToolTest touches(tool_, radius2_);
  found_size_ = 0;
  grid_.for_each_run(box_around(tool_, pose, margin), [&](std::uint32_t first, std::uint32_t last) {
    // Whole packs, so the first and last one may reach into neighbouring columns: those lanes are passed over.
    for (std::size_t i = first / simd::lanes * simd::lanes; i < last; i += simd::lanes) {
      const simd::Mask hit = touches(AxialPack(pose, grid_.x() + i, grid_.y() + i, grid_.z() + i));
      if (!simd::any(hit)) continue;
      for (std::size_t lane = 0; lane < simd::lanes; ++lane) {
        if (i + lane >= first && i + lane < last && simd::lane(hit, lane)) {
          found_[found_size_++] = grid_.shell_index(i + lane);
        }
      }
    }
    work_.points_tested += last - first;
  });
}

}  // namespace hapbench
