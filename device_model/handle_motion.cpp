#include "device_model/handle_motion.hpp"

#include <cmath>

namespace hapbench {

HandleMotion::HandleMotion(const HandleMotionConfig& config, const AttachedHand& hand)
    : config_(config),
      hand_(hand),
      mass_(config.mass + hand.mass),
      law_{(config.viscous + hand.damping) / mass_, hand.stiffness / mass_} {}

void HandleMotion::reset(const HandleState& handle) noexcept {
  handle_ = handle;
  work_ = {};
  stored_at_reset_ = 0.5 * config_.mass * handle_.velocity.squaredNorm();
  take_hand(Vec3::Zero());
}

void HandleMotion::take_hand(const Vec3& force) noexcept {
  origin_ = handle_.position;
  push_ = force + hand_.damping * handle_.velocity;
}

void HandleMotion::advance(const Vec3& motors, const FreeMotion& stretch) noexcept {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (config_.coulomb == 0.0) {
      move(axis, motors[axis], 0.0, stretch);
    } else {
      advance_with_friction(axis, motors[axis], stretch);
    }
  }
}

/// Force of the hand on the handle where it is, were it at rest [N].
double HandleMotion::hand_at_rest(Eigen::Index axis) const noexcept {
  return push_[axis] - hand_.stiffness * (handle_.position[axis] - origin_[axis]);
}

void HandleMotion::advance_with_friction(Eigen::Index axis, double motors, const FreeMotion& stretch) noexcept {
  double& v = handle_.velocity[axis];
  for (double left = stretch.time; left > 0.0;) {
    const double force = motors + hand_at_rest(axis);
    if (v == 0.0 && std::abs(force) <= config_.coulomb) return;  // sticks; nothing changes until a force does
    const double friction = std::copysign(config_.coulomb, v == 0.0 ? -force : -v);
    const double stops = time_of_rest(law_, v, (force + friction) / mass_);
    if (!(stops < left)) return move(axis, motors, friction, left == stretch.time ? stretch : free_motion(law_, left));
    move(axis, motors, friction, free_motion(law_, stops));
    v = 0.0;
    left -= stops;
  }
}

/// Precondition: the velocity keeps its sign, if there is friction.
void HandleMotion::move(Eigen::Index axis, double motors, double friction, const FreeMotion& by) noexcept {
  const double hand = hand_at_rest(axis), v = handle_.velocity[axis];
  const double g = (motors + hand + friction) / mass_;
  const double way = v * by.S + g * by.P, after = v * by.V + g * by.S;
  const double squares = v * v * by.W + v * g * by.S * by.S + g * g * by.Z;  // integral of the velocity's
  handle_.position[axis] += way;
  handle_.velocity[axis] = after;
  work_.actuator += motors * way;
  work_.hand += hand * way - 0.5 * hand_.stiffness * way * way - hand_.damping * squares -
                0.5 * hand_.mass * (after * after - v * v);
  work_.dissipated += friction * way - config_.viscous * squares;
}

DeviceEnergy HandleMotion::energy() const noexcept {
  DeviceEnergy energy = work_;
  energy.stored = 0.5 * config_.mass * handle_.velocity.squaredNorm() - stored_at_reset_;
  return energy;
}

}  // namespace hapbench
