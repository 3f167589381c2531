#include "sim/contact/grid_query.hpp"

#include <algorithm>
#include <bit>

namespace hapbench {

GridQuery::GridQuery(const PointShell& shell, const ToolShape& tool)
    : shell_(&shell), tool_(&tool), grid_(shell), scan_(grid_), found_(shell.size()) {}

void GridQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  // Far above the rounding of the box and of the test, far below a cell.
  const double reach = tool_->reach();
  const double margin = 1e-9 * reach + 1e-12 * (pose.position.cwiseAbs().maxCoeff() + reach);
  work_.points_tested += scan_.select(tool_->box_near(pose, margin, grid_.bounds()));
  if (!grid_.keeps_order()) return push_sorted(pose, contacts);
  // The grid's order is the shell's.
  const PointColumns points{grid_.shell_indices(), shell_->x(),  shell_->y(), shell_->z(),
                            shell_->nx(),          shell_->ny(), shell_->nz()};
  tool_->push_inside(pose, points, scan_.packs(), contacts);
}

void GridQuery::push_sorted(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  tool_->mark_inside(pose, scan_.points(), scan_.packs(), scan_.marks());
  std::size_t found = 0;
  scan_.for_each_hit([&](std::uint8_t hits, std::size_t i) {
    for (; hits != 0; hits &= static_cast<std::uint8_t>(hits - 1)) {
      found_[found++] = grid_.shell_index(i + static_cast<std::size_t>(std::countr_zero(hits)));
    }
  });
  std::sort(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(found));
  for (std::size_t k = 0; k < found; ++k) {
    const SurfacePoint point = shell_->point(found_[k]);
    contacts.push(found_[k], point.position, point.normal);
  }
}

}  // namespace hapbench
