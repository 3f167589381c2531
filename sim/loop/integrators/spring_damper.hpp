#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim/loop/integrators/table.hpp"

/// The linear system on which the stability of integrators is judged (thesis A.3).
namespace hapbench {

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
  /// True while no eigenvalue leaves the unit circle by more than rounding. Uses trace and determinant, because
  /// eigenvalues near -1 have errors of the order of the square root of rounding.
  bool is_stable() const;
  /// Positive if a step is stable (leapfrog: 4 - 2 lambda B dt / M - lambda K dt^2 / M); nullopt if the integrator has
  /// no closed form.
  std::optional<double> margin() const;
};

}  // namespace hapbench
