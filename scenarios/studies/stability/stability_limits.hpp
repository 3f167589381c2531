#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/description/scenario.hpp"
#include "sim/loop/integrators/spring_damper.hpp"

/// The integrator's stability on a set of bilateral springs (thesis A.3): how stiff, how damped and how coarse in time
/// a run may be before it blows up. Along the stiffest direction the springs act as one spring lambda K with one damper
/// lambda B, lambda = lambda_max(S), and the step (x, v) -> A (x, v) is stable while no eigenvalue of A leaves the unit
/// circle, under leapfrog (Eq. A.2) while 4 - 2 lambda B dt / M - lambda K dt^2 / M > 0. With a device the loop is
/// larger (DeviceLoop).
namespace hapbench {

/// Relative width at which bisection on runs stops: a hundredth of the 1 % within which the three ways must agree.
inline constexpr double kLimitTolerance = 1e-4;

/// The largest stable value of one case, found three ways; infinite when nothing up to 1e15, or 1e6 s, is unstable.
struct StabilityLimit {
  StabilityCase which;
  std::string name;
  std::string unit;
  std::optional<double> analytic = {};  ///< in closed form; empty where the integrator has none
  double eigenvalue = 0.0;              ///< bisection on the eigenvalues of A
  double simulation = 0.0;              ///< bisection on runs of the real simulation
  double damping_at_limit = 0.0;        ///< B at the limit [N s/m]
  double lambda = 1.0;                  ///< lambda_max(S) of the springs under the scenario's algorithm
  /// Of a tool that dry friction holds on springs that press from one side, all alike: K with its bristle along the
  /// surface, on every axis lambda K + (1 - lambda / trace S)^2 K_t.
  bool stuck = false;

  /// The analytic limit, or the limit of the eigenvalues if there is none.
  double limit() const { return analytic.value_or(eigenvalue); }
};

/// A point of the root locus: the eigenvalues as the case's number grows.
struct RootLocusPoint {
  StabilityCase which;
  double value;
  std::complex<double> first, second;
};

/// The largest stable value of one case under the scenario's integrator, where the springs of its algorithm have the
/// given lambda: infinite when nothing is unstable, empty when the integrator has no closed form of it.
std::optional<double> analytic_limit(StabilityCase which, const Scenario& scenario, double lambda);

/// The same by bisection on the eigenvalues of A, to 1e-10, from `start` on (see largest_stable): infinite when nothing
/// up to 1e15, or 1e6 s, is unstable.
double eigenvalue_limit(StabilityCase which, const Scenario& scenario, double lambda, double start);

/// Throws InputError, with the place, unless the environment is bilateral springs without friction and limits.
void require_bilateral_springs(const Scenario& scenario);
/// The same unless the tool is alone with them, too: no hand, and a device that leaves the tool to the integrator.
void require_lasting_springs(const Scenario& scenario);

/// The stiffness tensor S of such a scenario under its algorithm, in units of K.
Mat3 stiffness_tensor_of(Scenario scenario);

/// All four limits, without dry friction; with it a fifth of the tool that it holds, unless the springs cannot all
/// press alike. A limit that does not exist (no spring, no damping) is infinite. Throws InputError unless the scenario
/// is bilateral springs without viscous friction and limits: elsewhere contacts come and go and no such limit exists.
std::vector<StabilityLimit> stability_limits(const Scenario& scenario);

/// The eigenvalues from zero to a quarter beyond each finite limit.
std::vector<RootLocusPoint> root_locus(const Scenario& scenario, const std::vector<StabilityLimit>& limits);

/// The tool along a direction in which the stiffness of the scenario's springs is lambda K, without a device.
SpringDamper tool_on_spring(const Scenario& scenario, double lambda);

/// The scenario along a surface on which dry friction holds its tool: with the bristle in place of the springs. The
/// bristle adds up the device's velocity, and so sees the position through the velocity's filter.
Scenario stuck_scene(Scenario scenario);

/// Device, hand and wall of a scenario as a linear loop, as it is while nothing saturates and the contact lasts.
struct DeviceLoop {
  std::variant<SampledLoop, AdmittanceLoop> loop;
  std::string no_theory;  ///< why the loop's eigenvalues do not tell its stability; empty where they do

  Eigen::MatrixXd state_matrix() const {
    return std::visit([](const auto& linear) { return linear.state_matrix(); }, loop);
  }
};

/// The loop along a direction in which the springs' tensor has the eigenvalue lambda: the wall is lambda K, lambda B.
/// Precondition: the device is not ideal; that has no loop of its own.
DeviceLoop device_loop(const Scenario& scenario, double lambda);

/// The fields of the device that are not at their defaults and that no theory knows, as "device.viscous_N_s_per_m";
/// empty when there are none. Precondition: it is not ideal.
std::string unknown_to_theory(const Scenario& scenario);

/// The delay of the device's force, or of its servo [samples].
double delay_of(const Scenario& scenario);

/// The map of a step of the tool at a wall of lambda K and lambda B: by the device's loop, of an ideal device by the
/// integrator alone. Empty for a delay beyond 200 samples, which makes the loop too large to solve, and for a device
/// with fields that are unknown_to_theory.
Eigen::MatrixXd contact_step(const Scenario& scenario, double lambda);

}  // namespace hapbench
