#pragma once

namespace hapbench {

/// A body on a spring and a damper under a constant force, per unit of its mass, from where it is:
///
///   x'' = g - damping x' - stiffness x,   x(0) = 0,   x'(0) = v
struct MotionLaw {
  double damping = 0.0;    ///< [1/s], >= 0
  double stiffness = 0.0;  ///< [1/s^2], >= 0
};

/// Its exact solution after `time`:
///
///   x = v S + g P,   x' = v V + g S,   integral of x'^2 = v^2 W + v g S^2 + g^2 Z
struct FreeMotion {
  double time = 0.0;  ///< [s]
  double S = 0.0, P = 0.0, V = 1.0;
  double W = 0.0, Z = 0.0;
};

/// Relative error a few roundings for every damping, stiffness and time, whether it swings or creeps: the power series
/// of a fraction of the time, doubled up. About 0.1 us.
FreeMotion free_motion(const MotionLaw& law, double time) noexcept;

/// When the velocity is first zero after the start [s], by the closed form; infinity for never.
double time_of_rest(const MotionLaw& law, double v, double g) noexcept;

}  // namespace hapbench
