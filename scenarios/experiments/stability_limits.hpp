#pragma once

#include <complex>
#include <string>
#include <vector>

#include "scenarios/config/scenario.hpp"

/// The integrator's stability on a set of bilateral springs (thesis A.3): how stiff, how damped and how coarse in time
/// a run may be before it blows up. Along the stiffest direction the springs act as one spring lambda K with one damper
/// lambda B, lambda = lambda_max(S), and the step (x, v) -> A (x, v) of Eq. A.2 is stable while no eigenvalue of A
/// leaves the unit circle, that is while 4 - 2 lambda B dt / M - lambda K dt^2 / M > 0.
namespace hapbench {

/// One spring-damper under the leapfrog integrator.
struct SpringDamper {
  double K = 0.0;       ///< [N/m]
  double B = 0.0;       ///< [N s/m]
  double M = 0.1;       ///< [kg]
  double dt = 0.0005;   ///< [s]
  double lambda = 1.0;  ///< factor on K and B

  /// The two eigenvalues of the matrix A of Eq. A.2.
  std::pair<std::complex<double>, std::complex<double>> eigenvalues() const;
  /// Largest modulus of the two.
  double spectral_radius() const;
  /// 4 - 2 lambda B dt / M - lambda K dt^2 / M: positive where stable.
  double margin() const;
};

/// Which number is raised until the run blows up.
enum class StabilityCase {
  stiffness_undamped,  ///< K, with B = 0
  damping_alone,       ///< B, with K = 0
  stiffness_damped,    ///< K, with B = 2 zeta sqrt(K M) of the scenario's zeta
  time_step            ///< dt, with the scenario's K and zeta
};

inline constexpr StabilityCase kStabilityCases[] = {StabilityCase::stiffness_undamped, StabilityCase::damping_alone,
                                                    StabilityCase::stiffness_damped, StabilityCase::time_step};

/// The largest stable value of one case, found three ways.
struct StabilityLimit {
  StabilityCase which;
  std::string name;
  std::string unit;
  double analytic = 0.0;          ///< from the inequality above
  double eigenvalue = 0.0;        ///< bisection on the spectral radius of A
  double simulation = 0.0;        ///< bisection on runs of the real simulation
  double damping_at_limit = 0.0;  ///< B at the analytic limit [N s/m]
  double lambda = 1.0;            ///< lambda_max(S) of the springs under the scenario's algorithm
};

/// A point of the root locus: the eigenvalues as the case's number grows.
struct RootLocusPoint {
  StabilityCase which;
  double value;
  std::complex<double> first, second;
};

/// The largest stable value of one case where the springs of the scenario's algorithm have the given lambda; infinite
/// when there is none. Precondition: defaults are filled in.
double analytic_limit(StabilityCase which, const Scenario& scenario, double lambda);

/// All four limits. A limit that does not exist (no spring, no damping) is infinite. Throws InputError unless the
/// scenario is bilateral springs without friction and limits: elsewhere contacts come and go and no such limit exists.
std::vector<StabilityLimit> stability_limits(const Scenario& scenario);

/// The eigenvalues from zero to a quarter beyond each finite limit.
std::vector<RootLocusPoint> root_locus(const Scenario& scenario, const std::vector<StabilityLimit>& limits);

}  // namespace hapbench
