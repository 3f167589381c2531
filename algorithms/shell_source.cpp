#include "algorithms/shell_source.hpp"

#include <utility>

namespace hapbench {

ShellSource::ShellSource(const PointShell& shell, const ToolShape& tool, std::unique_ptr<ContactQuery> search,
                         std::unique_ptr<DepthModel> depth_model, Skips skips)
    : tool_(&tool), search_(std::move(search)), depth_model_(std::move(depth_model)), skips_(skips) {
  depth_model_->prepare(shell);
}

void ShellSource::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  search_->contacts_at(pose, contacts);
  if (contacts.empty() && knows_of_no_contacts_ && skips_ == Skips::on) return;
  depth_model_->evaluate(*tool_, pose, contacts);
  knows_of_no_contacts_ = contacts.empty();
}

void ShellSource::reset() noexcept {
  search_->reset();
  depth_model_->reset();
  knows_of_no_contacts_ = false;
}

}  // namespace hapbench
