#include "sim/contact/spring_source.hpp"

#include <cstdint>

namespace hapbench {

void SpringSource::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  contacts.clear();
  for (std::size_t j = 0; j < springs_->gradients.size(); ++j) {
    const Vec3& u = springs_->gradients[j];
    const double depth = pose.position.dot(u);
    if (!springs_->bilateral && !(depth > 0.0)) continue;
    const bool turned = !springs_->signed_depths && depth < 0.0;
    push_spring(j, pose.position, turned ? -depth : depth, turned ? Vec3(-u) : u, contacts);
  }
  contacts.pad();
  ++work_.queries;
  work_.points_tested += springs_->gradients.size();
}

void push_spring(std::size_t spring, const Vec3& position, double depth, const Vec3& gradient,
                 ContactBuffer& contacts) {
  contacts.push(static_cast<std::uint32_t>(spring), position, -gradient);
  contacts.depth[contacts.size() - 1] = depth;
  contacts.set_gradient(contacts.size() - 1, gradient);
}

}  // namespace hapbench
