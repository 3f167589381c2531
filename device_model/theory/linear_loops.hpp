#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "device_model/admittance_device.hpp"
#include "device_model/impedance_device.hpp"
#include "sim/loop/integrators/table.hpp"

/// The loops of device, hand and wall, whose step is a linear map of their state, and where they become unstable.
namespace hapbench {

/// The eigenvalues of a square matrix, in no particular order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

/// True if no eigenvalue leaves the unit circle by more than rounding, for entries of comparable size.
inline bool is_stable_step(const Eigen::MatrixXd& A) {
  return std::sqrt(eigenvalues(A).cwiseAbs2().maxCoeff()) <= 1.0 + 1e-13;
}

/// The largest value from `least` to `most` up to which the step `step_matrix(value)` is stable, with a relative error
/// of 1e-11; zero if `least` is unstable, infinite if all values are stable.
///
/// Values a tenth apart are tried from `least` on, and the first unstable one is bisected against the last stable one.
/// An unstable range that begins and ends within a tenth is overlooked.
template <class StepMatrix>
double first_edge(double least, double most, StepMatrix step_matrix) {
  constexpr double kNext = 1.1, kPrecision = 1e-11;
  const auto stable = [&](double value) { return is_stable_step(step_matrix(value)); };
  double low = 0.0, high = least;
  for (; stable(high); high *= kNext) {
    low = high;
    if (kNext * high > most) return std::numeric_limits<double>::infinity();
  }
  if (low == 0.0) return 0.0;
  while (high / low > 1.0 + kPrecision) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

/// The loop of an impedance device at a wall, as a linear system along one axis in SI units, without saturation,
/// Coulomb friction, and steps of encoder and force. A handle m x'' = f - b x', with or without a hand, moves freely
/// between samples. At sample k the wall answers
///
///   f_k = -K y_k - B w_k,   w_k = F((y_k' - y_{k-1}') / T)
///
/// which is held on the handle from t_k + d T for one period. y' is the position with the sensor's noise, y that
/// through the position filter, F the low-pass of the velocity filter. The springs of the wall act to both sides. With
/// an elastic transmission y, b and the force are the motors', and the hand is at the handle, a second mass.
struct SampledLoop {
  ImpedanceDeviceConfig device;  ///< with m, b, d and the velocity filter
  AttachedHand hand;             ///< zeros: no hand
  double period = 0.001;         ///< T [s]
  double stiffness = 0.0;        ///< K of the wall [N/m]
  double wall_damping = 0.0;     ///< B of the wall [N s/m]

  double moving_mass() const { return device.handle_mass + hand.mass; }   ///< handle and hand [kg]
  double total_damping() const { return device.viscous + hand.damping; }  ///< handle and hand [N s/m]
  /// Says which property of the device the linear system does not have; null if none.
  const char* nonlinearity() const;

  /// The map of the state at sample k to that at k + 1,
  ///   (x_k, T v_k, y'_{k-1}, modes of T w_{k-1} and of y_{k-1}, T^2/m f_{k-1}, T^2/m f_{k-2}, …),
  /// with the true velocity v of the handle, the moving mass m and as many forces as are on their way; a pair of poles
  /// has two components, a real pole or none has one. With a transmission x and v are the motors', and those of the
  /// handle are the last two components. All components are in metres, so that the eigenvalues are exact to rounding.
  /// The motion between samples is exact (matrix exponential).
  Eigen::MatrixXd state_matrix() const;
};

/// The largest K up to which the loop is stable (first_edge), with its other parameters. Zero if there is none above
/// 1e-8 m / T^2. Takes about 0.5 ms.
double eigenvalue_edge(SampledLoop loop);

/// Typical hands (100 to 1000 N/m, 0.1 to 0.5 kg), and no hand. They add no damping, because a hand that does is safer.
std::span<const AttachedHand> hand_family();

/// The smallest eigenvalue_edge of the loop with each hand of the family in place of its own.
double worst_hand_edge(SampledLoop loop);

/// A limit from the literature of the stiffness K that an impedance device can render. In the texts, b is the damping
/// of the handle, m the moving mass, t_d = d T.
struct StiffnessLimit {
  const char* name;  ///< name of its column and its curve
  const char* formula;
  const char* source;
  const char* applies;  ///< conditions
  /// The largest K [N/m], whatever the loop's own K is. No value if the limit does not apply, zero if it allows no K,
  /// infinity if it allows every K.
  std::optional<double> (*largest)(const SampledLoop& loop);
};

/// The table of limits, which everything that draws or writes limits reads.
std::span<const StiffnessLimit> stiffness_limits();

/// The loop of an AdmittanceDevice at a wall, as a linear system along one axis, while neither the limiter of the input
/// nor the servo saturates and the contact lasts. In each step the hand's force f = -k x_h - b v_h at the row drives
/// the handle and the virtual mass, which the wall holds; the servo then follows the mass.
struct AdmittanceLoop {
  SpringDamper tool;  ///< the virtual mass at the wall, with time step and integrator
  PositionServoConfig servo;
  HandleMechanicsConfig mechanics;
  double hand_stiffness = 0.0;  ///< k [N/m]
  double hand_damping = 0.0;    ///< b [N s/m]

  /// The map of the state at one row to that at the next,
  ///   (x, T v of the virtual mass, of the carriage, of the handle, T^2/M of the servo's delayed commands, last first)
  /// with the time step T and the virtual mass M, all in metres.
  Eigen::MatrixXd state_matrix() const;
};

/// Eigenvalues of the matrices of longer delays take seconds [samples].
inline constexpr double kLongestLoopDelay = 200.0;

/// Device, hand and wall as a linear loop, as it is while nothing saturates and the contact lasts.
struct DeviceLoop {
  std::variant<SampledLoop, AdmittanceLoop> loop;
  std::string no_theory;  ///< why the loop's eigenvalues do not tell its stability; empty where they do

  Eigen::MatrixXd state_matrix() const {
    return std::visit([](const auto& linear) { return linear.state_matrix(); }, loop);
  }
};

}  // namespace hapbench
