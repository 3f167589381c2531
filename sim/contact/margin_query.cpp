#include "sim/contact/margin_query.hpp"

#include <utility>

namespace hapbench {

Tool grown(const Tool& tool, double margin) noexcept {
  const double ends = tool.tip == Tip::round ? margin : 2.0 * margin;  // a round tip grows with the radius
  return {tool.radius + margin, tool.length + ends, tool.tip};
}

MarginQuery::MarginQuery(std::unique_ptr<ContactQuery> query, const Tool& tool, double margin)
    : MarginQuery(std::move(query), tool.tip == Tip::round ? 0.0 : margin) {}

MarginQuery::MarginQuery(std::unique_ptr<ContactQuery> query, double forward)
    : query_(std::move(query)), forward_(forward) {}

void MarginQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  query_->contacts_at({pose.position + forward_ * pose.axis, pose.axis}, contacts);
  work_ = query_->work();
}

/// The inner query moves its own grown tool ahead.
std::unique_ptr<ContactQuery> MarginQuery::with_margin(double margin) const {
  return std::unique_ptr<ContactQuery>(new MarginQuery(query_->with_margin(margin), forward_));
}

void MarginQuery::reset() noexcept {
  query_->reset();
  work_ = {};
}

}  // namespace hapbench
