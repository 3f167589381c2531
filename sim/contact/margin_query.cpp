#include "sim/contact/margin_query.hpp"

namespace hapbench {

MarginQuery::MarginQuery(ToolShape::Grown tool, std::unique_ptr<ContactQuery> query)
    : tool_(std::move(tool)), query_(std::move(query)) {}

void MarginQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  query_->contacts_at({pose.position + tool_.forward * pose.axis, pose.axis, pose.roll}, contacts);
  work_ = query_->work();
}

/// The inner query moves its own grown tool ahead.
std::unique_ptr<ContactQuery> MarginQuery::with_margin(double margin) const {
  return std::make_unique<MarginQuery>(ToolShape::Grown{nullptr, tool_.forward}, query_->with_margin(margin));
}

void MarginQuery::reset() noexcept {
  query_->reset();
  work_ = {};
}

}  // namespace hapbench
