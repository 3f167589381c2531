#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>

#include "device_model/attached_hand.hpp"

/// The loop of an impedance device at a wall, as a linear system: what stays of it while nothing saturates, without
/// Coulomb friction and without steps of encoder and force. Along one axis, SI units.
namespace hapbench {

/// A handle m x'' = f - b x', with or without a hand, moves freely between samples. At sample k the wall answers
///
///   f_k = -K x_k - B w_k,   w_k = a w_{k-1} + (1 - a) (x_k - x_{k-1}) / T
///
/// which is held on the handle from t_k + d T for one period. a = 0: the difference; with a cut-off f_c a first-order
/// low-pass of it, a = exp(-2 pi f_c T). Springs on both sides: a wall that only pushes would let go of the handle, and
/// the loop would be another one.
struct SampledLoop {
  double handle_mass = 0.1;      ///< m [kg]
  double damping = 0.0;          ///< b, of the handle alone [N s/m]
  AttachedHand hand;             ///< all zero: none
  double period = 0.001;         ///< T [s]
  double delay = 0.0;            ///< d [samples], whole or not
  std::optional<double> cutoff;  ///< f_c of the velocity filter [Hz]; none: the difference
  double stiffness = 0.0;        ///< K of the wall [N/m]
  double wall_damping = 0.0;     ///< B of the wall [N s/m]

  // Not part of the linear loop; limits that know of them ask for them.
  double coulomb = 0.0;       ///< c, friction of the handle [N]
  double encoder_step = 0.0;  ///< q [m]

  double moving_mass() const { return handle_mass + hand.mass; }   ///< of handle and hand [kg]
  double total_damping() const { return damping + hand.damping; }  ///< of handle and hand [N s/m]
  bool has_whole_delay() const { return delay == std::trunc(delay); }
  /// The share a of the filter's memory.
  double filter_memory() const;

  /// The map of the state at sample k to that at k + 1,
  ///   (x_k, T v_k, x_{k-1}, T w_{k-1}, T^2/m f_{k-1}, T^2/m f_{k-2}, …),
  /// v the handle's true velocity, m the moving mass, as many forces as are on their way. All in metres, so that its
  /// eigenvalues are known to rounding. The way between samples is exact (matrix exponential).
  Eigen::MatrixXd state_matrix() const;
};

/// The exact limit: the largest K at which no eigenvalue of the loop has left the unit circle, everything else as it
/// is; the first edge from below (first_edge). Zero when there is none above 1e-8 m / T^2. About 0.5 ms.
double eigenvalue_edge(SampledLoop loop);

/// Hands that a device meets (the usual range: 100 to 1000 N/m, 0.1 to 0.5 kg), and none. They add no damping: a hand
/// that does is safer.
std::span<const AttachedHand> hand_family();

/// The least eigenvalue_edge over the family, in place of the loop's own hand.
double worst_hand_edge(SampledLoop loop);

}  // namespace hapbench
