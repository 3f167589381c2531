#include "sim/contact/contact_query.hpp"

#include <bit>

#include "sim/contact/neighbour_list_query.hpp"

namespace hapbench {

std::unique_ptr<ContactQuery> make_contact_query(const PointShell& shell, const ToolShape& tool, Skips skips) {
  if (skips == Skips::off) return std::make_unique<ShellQuery>(shell, tool);
  return std::make_unique<NeighbourListQuery>(shell, tool);
}

ShellQuery::ShellQuery(const PointShell& shell, const ToolShape& tool)
    : shell_(&shell), tool_(&tool), marks_(shell.padded_size() / simd::lanes) {}

void ShellQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  const PointShell& shell = *shell_;
  const PackRange all{0, marks_.size()};
  tool_->mark_inside(pose, {shell.x(), shell.y(), shell.z()}, {&all, 1}, marks_.data());

  contacts.clear();
  for (std::size_t pack = 0; pack < marks_.size(); ++pack) {
    for (std::uint8_t hits = marks_[pack]; hits != 0; hits &= static_cast<std::uint8_t>(hits - 1)) {
      const std::size_t i = pack * simd::lanes + static_cast<std::size_t>(std::countr_zero(hits));
      const SurfacePoint point = shell.point(i);
      contacts.push(static_cast<std::uint32_t>(i), point.position, point.normal);
    }
  }
  ++work_.queries;
  work_.points_tested += shell.size();
}

}  // namespace hapbench
