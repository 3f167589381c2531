#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <utility>

#include "sim/loop/integrators/table.hpp"

/// The linear system on which the stability of integrators is judged (thesis A.3).
namespace hapbench {

/// The larger modulus of two numbers.
double spectral_radius(std::complex<double> a, std::complex<double> b);

/// One spring-damper, M x'' = -lambda (K x + B x'), under an integrator: each step is a linear map of (x, v).
struct SpringDamper {
  double K = 0.0;       ///< [N/m]
  double B = 0.0;       ///< [N s/m]
  double M = 0.1;       ///< [kg]
  double dt = 0.0005;   ///< [s]
  double lambda = 1.0;  ///< factor on K and B
  const IntegratorEntry* integrator = &kLeapfrog;

  /// The matrix that maps (x, v) over one step: the integrator's closed form, or else the results of its steps from
  /// (1, 0) and (0, 1).
  Eigen::Matrix2d step_matrix() const;
  /// The change of (x, v) in a step for each newton of a force held over the step, from the integrator itself.
  Eigen::Vector2d input_step() const;
  /// The two eigenvalues of the step matrix.
  std::pair<std::complex<double>, std::complex<double>> eigenvalues() const;
  double spectral_radius() const;
  /// True while no eigenvalue leaves the unit circle by more than rounding. Uses trace and determinant, because
  /// eigenvalues near -1 have errors of the order of the square root of rounding.
  bool is_stable() const;
  /// Positive if a step is stable (leapfrog: 4 - 2 lambda B dt / M - lambda K dt^2 / M); nullopt if the integrator has
  /// no closed form.
  std::optional<double> margin() const;
};

/// The number that is raised until the run becomes unstable.
enum class StabilityCase {
  stiffness_undamped,  ///< K, with B = 0
  damping_alone,       ///< B, with K = 0
  stiffness_damped,    ///< K, with B as given
  time_step            ///< dt, with K and B as given
};

inline constexpr StabilityCase kStabilityCases[] = {StabilityCase::stiffness_undamped, StabilityCase::damping_alone,
                                                    StabilityCase::stiffness_damped, StabilityCase::time_step};

/// A spring-damper with one number to be raised.
struct RaisedSpringDamper {
  StabilityCase raised;
  SpringDamper given;             ///< its B is ignored
  std::optional<double> damping;  ///< B [N s/m]; 2 zeta sqrt(K M) if not given
  double damping_ratio = 0.0;     ///< zeta

  /// The system with the raised number at `value`.
  SpringDamper at(double value) const;
};

/// Stability limits of an integrator: of lambda K dt^2 / M without damping and of lambda B dt / M without a spring.
struct LimitsAlone {
  double spring;
  double damper;
};

/// The limit of a problem with a spring or a damper; infinite if it has neither, nullopt if it has both.
std::optional<double> limit_of_one_alone(const RaisedSpringDamper& problem, const LimitsAlone& limits);

}  // namespace hapbench
