#pragma once

#include <Eigen/Core>
#include <complex>
#include <utility>

#include "sim/loop/integrators/integrator.hpp"

namespace hapbench {

/// One spring-damper, M x'' = -lambda (K x + B x'), under an integrator: each step is a linear map of (x, v).
struct SpringDamper {
  double K = 0.0;       ///< [N/m]
  double B = 0.0;       ///< [N s/m]
  double M = 0.1;       ///< [kg]
  double dt = 0.0005;   ///< [s]
  double lambda = 1.0;  ///< factor on K and B
  Integrator integrator = Integrator::leapfrog;

  /// What one step makes of (x, v): under leapfrog the matrix A of Eq. A.2, under the others built from the integrator
  /// itself, applied to (1, 0) and (0, 1).
  Eigen::Matrix2d step_matrix() const;
  /// The two eigenvalues of that matrix.
  std::pair<std::complex<double>, std::complex<double>> eigenvalues() const;
  /// Largest modulus of the two.
  double spectral_radius() const;
  /// True while none leaves the unit circle by more than rounding. Judged by trace and determinant: where both
  /// eigenvalues come close to -1 they are known to the root of rounding only.
  bool is_stable() const;
  /// 4 - 2 lambda B dt / M - lambda K dt^2 / M: positive where leapfrog is stable.
  double margin() const;
};

}  // namespace hapbench
