#include "sim/contact/spring_query.hpp"

#include <utility>

namespace hapbench {

SpringQuery::SpringQuery(SpringSet springs) : springs_(std::move(springs)) {}

void SpringQuery::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  contacts.clear();
  for (std::size_t j = 0; j < springs_.gradients.size(); ++j) {
    const Vec3& u = springs_.gradients[j];
    const double depth = pose.position.dot(u);
    if (!springs_.bilateral && !(depth > 0.0)) continue;
    contacts.push(static_cast<std::uint32_t>(j), pose.position, -u);
    contacts.depth[contacts.size() - 1] = depth;
    contacts.set_gradient(contacts.size() - 1, u);
  }
  contacts.pad();
  ++work_.queries;
  work_.points_tested += springs_.gradients.size();
}

}  // namespace hapbench
