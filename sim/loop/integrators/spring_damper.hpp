#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <utility>

#include "sim/loop/integrators/table.hpp"

/// The system that the stability of integrators is about (thesis A.3).
namespace hapbench {

/// One spring-damper, M x'' = -lambda (K x + B x'), under an integrator: each step is a linear map of (x, v).
struct SpringDamper {
  double K = 0.0;       ///< [N/m]
  double B = 0.0;       ///< [N s/m]
  double M = 0.1;       ///< [kg]
  double dt = 0.0005;   ///< [s]
  double lambda = 1.0;  ///< factor on K and B
  const IntegratorEntry* integrator = &kLeapfrog;

  /// What one step makes of (x, v): the integrator's closed form, or built from the integrator itself, applied to
  /// (1, 0) and (0, 1).
  Eigen::Matrix2d step_matrix() const;
  /// What a step adds to (x, v) for each newton of a force that is held over it, from the integrator itself.
  Eigen::Vector2d input_step() const;
  /// The two eigenvalues of that matrix.
  std::pair<std::complex<double>, std::complex<double>> eigenvalues() const;
  /// Largest modulus of the two.
  double spectral_radius() const;
  /// True while none leaves the unit circle by more than rounding. Judged by trace and determinant: where both
  /// eigenvalues come close to -1 they are known to the root of rounding only.
  bool is_stable() const;
  /// Positive where a step is stable (leapfrog: 4 - 2 lambda B dt / M - lambda K dt^2 / M); none where the integrator
  /// has no closed form.
  std::optional<double> margin() const;
};

/// Which number is raised until the run blows up.
enum class StabilityCase {
  stiffness_undamped,  ///< K, with B = 0
  damping_alone,       ///< B, with K = 0
  stiffness_damped,    ///< K, with B as given
  time_step            ///< dt, with K and B as given
};

inline constexpr StabilityCase kStabilityCases[] = {StabilityCase::stiffness_undamped, StabilityCase::damping_alone,
                                                    StabilityCase::stiffness_damped, StabilityCase::time_step};

/// A spring-damper of which one number is raised.
struct RaisedSpringDamper {
  StabilityCase raised;
  SpringDamper given;             ///< its B apart
  std::optional<double> damping;  ///< B [N s/m]; none: 2 zeta sqrt(K M)
  double damping_ratio = 0.0;     ///< zeta

  /// With what is raised at `value`.
  SpringDamper at(double value) const;
};

/// Where an integrator stops being stable: of lambda K dt^2 / M without damping, of lambda B dt / M without a spring.
struct LimitsAlone {
  double spring;
  double damper;
};

/// The limit of a problem that has a spring or a damper, infinite when it has neither; none with both.
std::optional<double> limit_of_one_alone(const RaisedSpringDamper& problem, const LimitsAlone& limits);

}  // namespace hapbench
