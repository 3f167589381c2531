#include "sim/contact/grid_query.hpp"

#include <algorithm>
#include <cmath>

#include "sim/contact/margin_query.hpp"
#include "sim/contact/push_hits.hpp"
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

std::unique_ptr<ContactQuery> GridQuery::with_margin(double margin) const {
  return std::make_unique<MarginQuery>(std::make_unique<GridQuery>(*shell_, grown(tool_, margin)), tool_, margin);
}

void GridQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  if (!grid_.keeps_order()) return push_sorted(pose, contacts);
  // The grid's order is the shell's.
  const PointColumns points{grid_.shell_indices(), shell_->x(),  shell_->y(), shell_->z(),
                            shell_->nx(),          shell_->ny(), shell_->nz()};
  for_each_hit(pose, [&](const simd::Mask& hit, std::size_t i) { push_hits(hit, points, i, contacts); });
}

void GridQuery::push_sorted(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  std::size_t found = 0;
  for_each_hit(pose, [&](const simd::Mask& hit, std::size_t i) {
    for (std::size_t lane = 0; lane < simd::lanes; ++lane) {
      if (simd::lane(hit, lane)) found_[found++] = grid_.shell_index(i + lane);
    }
  });
  std::sort(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(found));
  for (std::size_t k = 0; k < found; ++k) {
    const SurfacePoint point = shell_->point(found_[k]);
    contacts.push(found_[k], point.position, point.normal);
  }
}

/// Calls `take(hit, i)` where some of the eight points from i on, in the order of the grid, touch the tool.
template <class Take>
void GridQuery::for_each_hit(const ToolPose& pose, Take take) noexcept {
  // Far above the rounding of the box and of the test, far below a cell.
  const double margin = 1e-9 * reach_ + 1e-12 * (pose.position.cwiseAbs().maxCoeff() + reach_);
  const ToolTest touches(tool_, radius2_);
  grid_.for_each_run(box_around(tool_, pose, margin, grid_.bounds()), [&](std::uint32_t first, std::uint32_t last) {
    for (std::size_t i = first / simd::lanes * simd::lanes; i < last; i += simd::lanes) {
      simd::Mask hit = touches(AxialPack(pose, grid_.x() + i, grid_.y() + i, grid_.z() + i));
      if (!simd::any(hit)) continue;
      // Whole packs, so the first and last one may reach into neighbouring columns: those lanes are passed over.
      hit = hit && simd::lanes_between(first > i ? first - i : 0, last - i);
      take(hit, i);
    }
    work_.points_tested += last - first;
  });
}

}  // namespace hapbench
