#include "sim/contact/spring_query.hpp"

#include <utility>

namespace hapbench {

SpringQuery::SpringQuery(SpringSet springs) : springs_(std::move(springs)) {}

std::size_t SpringQuery::capacity() const noexcept {
  return springs_.gradients.size() * (margin_ && springs_.bilateral ? 2 : 1);
}

std::unique_ptr<ContactQuery> SpringQuery::with_margin(double margin) const {
  auto query = std::make_unique<SpringQuery>(springs_);
  query->margin_ = margin_.value_or(0.0) + margin;
  return query;
}

void SpringQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  contacts.clear();
  for (std::size_t j = 0; j < springs_.gradients.size(); ++j) {
    const Vec3& u = springs_.gradients[j];
    const double depth = pose.position.dot(u);
    const bool one_sided = !springs_.bilateral || margin_.has_value();
    if (!one_sided || depth > -margin_.value_or(0.0)) push(j, pose.position, depth, u, contacts);
    if (springs_.bilateral && margin_ && -depth > -*margin_) push(j, pose.position, -depth, -u, contacts);
  }
  contacts.pad();
  ++work_.queries;
  work_.points_tested += springs_.gradients.size();
}

void SpringQuery::push(std::size_t spring, const Vec3& position, double depth, const Vec3& gradient,
                       ContactBuffer& contacts) const noexcept {
  contacts.push(static_cast<std::uint32_t>(spring), position, -gradient);
  contacts.depth[contacts.size() - 1] = depth;
  contacts.set_gradient(contacts.size() - 1, gradient);
}

}  // namespace hapbench
