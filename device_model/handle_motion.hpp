#pragma once

#include "device_model/attached_hand.hpp"
#include "device_model/free_motion.hpp"
#include "sim/loop/device.hpp"

namespace hapbench {

/// The handle as a body.
struct HandleMotionConfig {
  double mass = 0.05;    ///< m [kg]
  double viscous = 0.0;  ///< b [N s/m]
  double coulomb = 0.0;  ///< c [N]
};

/// A handle with friction under forces that are held, each axis on its own, without any error of time steps:
///
///   m x'' = f - b x' - c sign(x') + f_hand
///
/// f_hand is held, too, or that of a hand fixed to the handle. Coulomb friction is exact: the instant at which the
/// handle stops is found from the closed form, there it sticks while the other forces sum up to no more than c, and
/// otherwise leaves in their direction. It stops once between two changes of a force, and a hand with a spring lets it
/// stop another time with each half of its swing, so that no step has more than 2 + w T / pi stops, w the frequency of
/// the swing.
class HandleMotion {
 public:
  HandleMotion(const HandleMotionConfig& config, const AttachedHand& hand);

  /// Law of the motion between stops; free_motion of it is what `advance` wants.
  const MotionLaw& law() const noexcept { return law_; }

  void reset(const HandleState& handle) noexcept;
  /// Takes the hand's force at a sample [N], which holds until the next call.
  void take_hand(const Vec3& force) noexcept;
  /// Moves on by `stretch.time` under a constant force of the motors [N]. Allocates nothing.
  void advance(const Vec3& motors, const FreeMotion& stretch) noexcept;

  const HandleState& handle() const noexcept { return handle_; }
  /// Of the handle without the mass of a hand that is fixed to it, whose inertia is part of the hand's work.
  DeviceEnergy energy() const noexcept;

 private:
  void advance_with_friction(Eigen::Index axis, double motors, const FreeMotion& stretch) noexcept;
  double hand_at_rest(Eigen::Index axis) const noexcept;
  void move(Eigen::Index axis, double motors, double friction, const FreeMotion& by) noexcept;

  HandleMotionConfig config_;
  AttachedHand hand_;
  double mass_;  ///< of handle and hand [kg]
  MotionLaw law_;
  HandleState handle_;
  Vec3 origin_ = Vec3::Zero();  ///< place of the handle at the sample [m]
  Vec3 push_ = Vec3::Zero();    ///< of the hand on a handle at rest there [N]
  DeviceEnergy work_;           ///< its `stored` is not kept up
  double stored_at_reset_ = 0.0;
};

}  // namespace hapbench
