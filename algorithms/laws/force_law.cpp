#include "algorithms/laws/force_law.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "sim/core/simd.hpp"

namespace hapbench {

void set_weights(ContactBuffer& contacts, double c) noexcept {
  std::fill_n(contacts.weight.begin(), contacts.size(), c);
  simd::zero_pack(&contacts.weight[contacts.size()]);
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
  using simd::load, simd::Pack;
  Pack x(0.0), y(0.0), z(0.0), weights(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack weight = load(&contacts.weight[i]);  // zero in the padding
    x += weight * (load(&contacts.x[i]) - Pack(tip.x()));
    y += weight * (load(&contacts.y[i]) - Pack(tip.y()));
    z += weight * (load(&contacts.z[i]) - Pack(tip.z()));
    weights += weight;
  }
  const double sum = simd::sum(weights);
  return sum > 0.0 ? Vec3(Vec3(simd::sum(x), simd::sum(y), simd::sum(z)) / sum) : Vec3::Zero();
}

SpringState SingleSpringLaw::spring_state(const ContactBuffer& contacts, const Vec3& spring,
                                          const Vec3& tip) const noexcept {
  if (gives_weights_) return ForceLaw::spring_state(contacts, spring, tip);
  if (K_ == 0.0) return {};
  return {spring.squaredNorm() / (2.0 * K_), mean_arm(contacts, tip).cross(spring)};
}

Vec3 SingleSpringLaw::turning_velocity(const ContactBuffer& contacts, const Mat3& S,
                                       const ToolState& tool) const noexcept {
  if (gives_weights_) return ForceLaw::turning_velocity(contacts, S, tool);
  return S * tool.angular_velocity.cross(mean_arm(contacts, tool.pose.position));
}

LawForce weighted_force(const ContactBuffer& contacts, double K) noexcept {
  return {-K * weighted_depth(contacts), stiffness_tensor(contacts)};
}

SpringState ForceLaw::spring_state(const ContactBuffer& contacts, const Vec3&, const Vec3& tip) const noexcept {
  using simd::load, simd::Pack;
  const Pack tip_x(tip.x()), tip_y(tip.y()), tip_z(tip.z());
  Pack energy(0.0), mx(0.0), my(0.0), mz(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack d = load(&contacts.depth[i]), cd = load(&contacts.weight[i]) * d;
    const Pack fx = cd * load(&contacts.ux[i]), fy = cd * load(&contacts.uy[i]), fz = cd * load(&contacts.uz[i]);
    const Pack x = load(&contacts.x[i]) - tip_x, y = load(&contacts.y[i]) - tip_y, z = load(&contacts.z[i]) - tip_z;
    energy += cd * d;
    mx += y * fz - z * fy;
    my += z * fx - x * fz;
    mz += x * fy - y * fx;
  }
  return {0.5 * K_ * simd::sum(energy), -K_ * Vec3(simd::sum(mx), simd::sum(my), simd::sum(mz))};
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
