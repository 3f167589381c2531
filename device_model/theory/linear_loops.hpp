#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "device_model/admittance_device.hpp"
#include "device_model/impedance_device.hpp"
#include "sim/loop/integrators/table.hpp"

/// Linear models of the closed loop of device, hand and wall, in which one step is a linear map of the state, and the
/// stability limits of these loops.
namespace hapbench {

/// Returns the eigenvalues of a square matrix, in no particular order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

/// Returns true if no eigenvalue is outside the unit circle by more than rounding. Precondition: the entries are of
/// comparable size.
inline bool is_stable_step(const Eigen::MatrixXd& A) {
  return std::sqrt(eigenvalues(A).cwiseAbs2().maxCoeff()) <= 1.0 + 1e-13;
}

/// Returns the stability limit: the largest value in [`lowest`, `highest`] up to which the step
/// `step_matrix(value)` is stable, with a relative error of 1e-11. Returns zero if `lowest` is unstable, infinity
/// if all tested values are stable.
///
/// Tests values that increase by a factor of 1.1 from `lowest` on and do not exceed `highest`, then bisects between the
/// last stable and the first unstable value. Misses an unstable range that lies between two neighbouring values, or
/// between the last value and `highest`.
template <class StepMatrix>
double first_stability_limit(double lowest, double highest, StepMatrix step_matrix) {
  constexpr double kNext = 1.1, kPrecision = 1e-11;
  const auto stable = [&](double value) { return is_stable_step(step_matrix(value)); };
  double low = 0.0, high = lowest;
  for (; stable(high); high *= kNext) {
    low = high;
    if (kNext * high > highest) return std::numeric_limits<double>::infinity();
  }
  if (low == 0.0) return 0.0;
  while (high / low > 1.0 + kPrecision) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

/// Linear model of an impedance device at a virtual wall, along one axis in SI units. Saturation, Coulomb friction
/// and the resolution of encoder and force are left out. The handle, m x'' = f - b x', with or without a hand,
/// moves freely between samples. At sample k the wall renders the force
///
///   f_k = -K y_k - B w_k,   w_k = F((y_k' - y_{k-1}') / T)
///
/// which acts on the handle from t_k + d T for one period. y' is the measured position with the sensor's noise, y
/// is y' after the position filter, and F is the low-pass of the velocity filter. The wall acts for positive and
/// negative y (bilateral contact). With an elastic transmission, y, b and the force belong to the motors, and the
/// hand to the handle, a second mass.
///
/// Two kinds of hands can hold the handle. An attached hand moves with the handle between samples. A sampled hand
/// renders the force -k x_k - c v_k of the handle's true position and velocity, held over the period, without delay.
struct SampledLoop {
  ImpedanceDeviceConfig device;    ///< contains m, b, d and the filters
  AttachedHand hand;               ///< all zero: no attached hand
  double sampled_stiffness = 0.0;  ///< stiffness k of a sampled hand [N/m]
  double sampled_damping = 0.0;    ///< damping c of a sampled hand [N s/m]
  double period = 0.001;           ///< T [s]
  double stiffness = 0.0;          ///< K of the wall [N/m]
  double wall_damping = 0.0;       ///< B of the wall [N s/m]

  double moving_mass() const { return device.handle_mass + hand.mass; }   ///< mass of handle and hand [kg]
  double total_damping() const { return device.viscous + hand.damping; }  ///< damping of handle and hand [N s/m]
  /// Returns a text that names the properties of the device that are not linear; null if the device is linear.
  const char* nonlinearity() const;

  /// Returns the matrix that maps the state at sample k to the state at sample k + 1. The state is
  ///   (x_k, T v_k, y'_{k-1}, modes of T w_{k-1} and of y_{k-1}, T^2/m f_{k-1}, T^2/m f_{k-2}, …),
  /// with the true velocity v of the handle, the moving mass m and the forces that are still delayed. In each filter, a
  /// pair of complex poles has two state components and a real pole has one component. Without a velocity filter, the
  /// state has one component T w_{k-1}. Without a position filter, the state has no component for this filter. With a
  /// transmission, x and v belong to the motors, and the handle's x and T v are the last two components. All components
  /// are in metres, so that rounding does not disturb the eigenvalues. The motion between samples is exact (matrix
  /// exponential).
  Eigen::MatrixXd state_matrix() const;
};

/// Returns the largest wall stiffness K [N/m] up to which `loop` is stable (first_stability_limit); all other
/// parameters of `loop` are kept. Returns zero if K T^2 / m would be below 1e-8, with the period T and the moving mass
/// m. Takes about 0.5 ms.
double linear_stability_limit(SampledLoop loop);

/// Returns a set of typical hands (100 to 1000 N/m, 0.1 to 0.5 kg); the first entry is no hand. The hands have no
/// damping, because damping of the hand only raises the limit.
std::span<const AttachedHand> typical_hands();

/// Returns the smallest linear_stability_limit over typical_hands(), where each typical hand in turn replaces the
/// hand of `loop`.
double worst_hand_stability_limit(SampledLoop loop);

/// A limit on the stiffness K that an impedance device can render, from the literature or derived for this project. In
/// `formula` and `applies`, b is the damping of the handle, m the moving mass, B the wall's damping, T the period and
/// t_d = d T the delay.
struct StiffnessLimit {
  const char* name;     ///< name of the limit's column in tables and of its curve in plots
  const char* formula;  ///< formula with the symbols defined above
  const char* source;   ///< citation, or "derived"
  const char* applies;  ///< conditions under which the limit is valid
  /// Returns the largest K [N/m]; the loop's stiffness is ignored. Returns nullopt if the limit does not apply to this
  /// loop, zero if no K > 0 satisfies the limit, infinity if every K does.
  std::optional<double> (*largest)(const SampledLoop& loop);
};

/// Returns the table of limits. Every plot and every printed table of limits is generated from this table.
std::span<const StiffnessLimit> stiffness_limits();

/// Linear model of an AdmittanceDevice at a virtual wall along one axis, valid while neither the input-force
/// limiter nor the servo saturates and the contact lasts. In each step the hand's force f = -k x_h - b v_h drives
/// the handle and the virtual mass, and the wall's spring acts on the virtual mass; the servo then follows the
/// virtual mass.
struct AdmittanceLoop {
  SpringDamper tool;  ///< virtual mass at the wall, time step and integrator
  PositionServoConfig servo;
  HandleMechanicsConfig mechanics;
  double hand_stiffness = 0.0;  ///< k of the hand [N/m]
  double hand_damping = 0.0;    ///< b of the hand [N s/m]

  /// Returns the matrix that maps the state at one step to the state at the next step. The state is
  ///   (x and T v of the virtual mass, of the carriage, of the handle; T^2/M times the servo's delayed commands)
  /// with the time step T, the virtual mass M and the newest command first. All components are in metres.
  Eigen::MatrixXd state_matrix() const;
};

/// Largest delay [samples] for which eigenvalues are computed. With longer delays, the computation would take seconds.
inline constexpr double kMaxLoopDelay = 200.0;

/// Linearisation of a tool in contact that a hand holds, in three dimensions: stiffness and damping of the rendered
/// force and of the hand. The axes may be coupled.
struct LinearContact {
  LinearForce rendered;  ///< derivatives of the rendered force with respect to position and velocity of the tool
  HandImpedance hand;    ///< linearised force of a sampled hand, which is held over each step
  /// Derivative of the force that drives a virtual mass with respect to the hand's force. Not the identity if the
  /// input-force limiter acts.
  Mat3 input = Mat3::Identity();
};

/// Returns the matrices that map the state at one step to the state at the next step, for the loop of a device in three
/// dimensions. Their eigenvalues together are the eigenvalues of the loop. Returns one matrix for each axis if there is
/// a frame in which no axes drive each other in both directions, otherwise a single matrix for all axes. Omits axes in
/// which neither contact nor hand acts. All components of the state are in metres. Returns an empty list if the axes
/// are coupled and the matrix would be larger than 300 x 300, because its eigenvalues would take longer than a second.
///
/// Ignores the stiffness and damping of wall, sampled hand and tool in the first argument; `contact` replaces them.
std::vector<Eigen::MatrixXd> contact_loop(const SampledLoop& loop, const LinearContact& contact);
std::vector<Eigen::MatrixXd> contact_loop(const AdmittanceLoop& loop, const LinearContact& contact);
/// Returns the matrices for the loop without a device: the hand's force drives the virtual mass of `tool`.
std::vector<Eigen::MatrixXd> contact_loop(const SpringDamper& tool, const LinearContact& contact);

/// Returns true if the matrices of contact_loop() have no eigenvalue outside the unit circle by more than rounding.
/// Eigenvalues within 1e-5 of 1 may be outside by 1e-6: they belong to a tool that moves freely in some direction,
/// whose double eigenvalue 1 is computed to the square root of rounding only.
bool is_stable_loop(const std::vector<Eigen::MatrixXd>& loop);

/// Linear loop of device, hand and wall, valid while nothing saturates and the contact lasts.
struct DeviceLoop {
  std::variant<SampledLoop, AdmittanceLoop> loop;
  std::string no_theory;  ///< reason why the eigenvalues do not decide the stability; empty if they decide it

  Eigen::MatrixXd state_matrix() const {
    return std::visit([](const auto& linear) { return linear.state_matrix(); }, loop);
  }
};

}  // namespace hapbench
