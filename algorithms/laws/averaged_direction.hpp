#pragma once

#include "algorithms/laws/force_law.hpp"
#include "algorithms/theory.hpp"

namespace hapbench {

/// What original_averaging and highest_depth have in common: one spring along the averaged gradient,
/// u_r = sum u_i / |sum u_i|, f = -K d_r u_r, S = u_r u_r^T. They differ in the depth d_r.
class AveragedDirectionLaw : public ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  /// One spring, compressed by d_r. The laws give it no point of application; the middle of the contacts is taken.
  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override;
  /// The velocity at that point of application, along u_r.
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override;

 protected:
  /// Below this mean gradient the direction is rounding noise, and the force is zero.
  static constexpr double kCancelledBelow = 1e-9;

  /// The law's answer with d_r = depth(|sum u_i|) [m]. Leaves weights of 1.
  template <class Depth>
  LawForce force_along_mean(ContactBuffer& contacts, const Depth& depth) const noexcept {
    set_weights(contacts, 1.0);
    const Vec3 gradients = gradient_sum(contacts);
    const double length = gradients.norm();
    if (length <= kCancelledBelow * static_cast<double>(contacts.size())) return {};
    const Vec3 u = gradients / length;
    return {-K_ * depth(length) * u, u * u.transpose()};
  }
};

/// S = u_r u_r^T, and the mean gradient u_r points straight into the wedge.
WedgeStiffness averaged_direction_wedge(const RenderingConfig& config, double w, double n);

}  // namespace hapbench
