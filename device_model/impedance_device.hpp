#pragma once

#include <optional>

#include "device_model/velocity_filter.hpp"

namespace hapbench {

/// An impedance display: a light handle with motors, which measures positions and renders forces.
struct ImpedanceDeviceConfig {
  double handle_mass = 0.05;   ///< of everything that moves, as felt at the handle [kg]
  double viscous = 0.0;        ///< friction b, each axis [N s/m]
  double coulomb = 0.0;        ///< friction c, each axis [N]
  double encoder_step = 0.0;   ///< q [m]; 0: exact
  double delay_samples = 0.0;  ///< d, from the sample to the force [periods], whole or not
  VelocityFilterConfig velocity_filter;
  std::optional<double> force_max;   ///< norm at which the motors saturate [N]
  double force_step = 0.0;           ///< resolution of each component [N]; 0: exact
  std::optional<double> force_slew;  ///< fastest change of the force, by its norm [N/s]
};

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
