#include "algorithms/laws/force_law.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "sim/core/simd.hpp"

namespace hapbench {

void set_weights(ContactBuffer& contacts, double c) noexcept {
  std::fill_n(contacts.weight.begin(), contacts.size(), c);
  std::fill(contacts.weight.begin() + static_cast<std::ptrdiff_t>(contacts.size()),
            contacts.weight.begin() + static_cast<std::ptrdiff_t>(contacts.padded_size()), 0.0);
}

Vec3 gradient_sum(const ContactBuffer& contacts) noexcept {
  using simd::load, simd::Pack;
  Pack x(0.0), y(0.0), z(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    x += load(&contacts.ux[i]);
    y += load(&contacts.uy[i]);
    z += load(&contacts.uz[i]);
  }
  return {simd::sum(x), simd::sum(y), simd::sum(z)};
}

Vec3 mean_arm(const ContactBuffer& contacts, const Vec3& tip) noexcept {
  Vec3 arms = Vec3::Zero();
  double weights = 0.0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    arms += contacts.weight[i] * (contacts.point(i) - tip);
    weights += contacts.weight[i];
  }
  return weights > 0.0 ? Vec3(arms / weights) : Vec3::Zero();
}

LawForce weighted_force(const ContactBuffer& contacts, double K) noexcept {
  return {-K * weighted_depth(contacts), stiffness_tensor(contacts)};
}

SpringState ForceLaw::spring_state(const ContactBuffer& contacts, const Vec3&, const Vec3& tip) const noexcept {
  SpringState state;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 force = -K_ * contacts.weight[i] * contacts.depth[i] * contacts.gradient(i);
    state.energy += 0.5 * K_ * contacts.weight[i] * contacts.depth[i] * contacts.depth[i];
    state.moment += (contacts.point(i) - tip).cross(force);
  }
  return state;
}

Vec3 ForceLaw::turning_velocity(const ContactBuffer& contacts, const Mat3&, const ToolState& tool) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 u = contacts.gradient(i);
    const Vec3 velocity = tool.angular_velocity.cross(contacts.point(i) - tool.pose.position);
    sum += contacts.weight[i] * velocity.dot(u) * u;
  }
  return sum;
}

}  // namespace hapbench
