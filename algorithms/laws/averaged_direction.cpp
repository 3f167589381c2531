#include "algorithms/laws/averaged_direction.hpp"

#include <Eigen/Geometry>

namespace hapbench {

SpringState AveragedDirectionLaw::spring_state(const ContactBuffer& contacts, const Vec3& spring,
                                               const Vec3& tip) const noexcept {
  if (K_ == 0.0) return {};
  return {spring.squaredNorm() / (2.0 * K_), mean_arm(contacts, tip).cross(spring)};
}

Vec3 AveragedDirectionLaw::turning_velocity(const ContactBuffer& contacts, const Mat3& S,
                                            const ToolState& tool) const noexcept {
  return S * tool.angular_velocity.cross(mean_arm(contacts, tool.pose.position));
}

WedgeStiffness averaged_direction_wedge(const RenderingConfig&, double, double) {
  return {1.0, 0.0};
}

}  // namespace hapbench
