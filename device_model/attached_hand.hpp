#pragma once

namespace hapbench {

/// How a hand's force answers the motion of the handle between samples:
///
///   f_hand = f_k - stiffness (x - x_k) - damping (x' - x'_k) - mass x''
///
/// with f_k its force at the sample. All zero for a hand whose force is sampled and held. Otherwise the hand is a mass,
/// fixed to the handle, on a spring and a damper towards a target whose place and velocity are those of the sample.
struct AttachedHand {
  double mass = 0.0;       ///< [kg]
  double stiffness = 0.0;  ///< [N/m]
  double damping = 0.0;    ///< [N s/m]
};

}  // namespace hapbench
