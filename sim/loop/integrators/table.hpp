#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>

#include "sim/core/types.hpp"
#include "sim/loop/force_algorithm.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// The force on the tool during one step, for integrators that evaluate the force more than once in a step.
class ForceField {
 public:
  virtual ~ForceField() = default;
  /// Returns the input force plus the rendered force, f_in + f_render [N], at the time t_k + fraction dt, 0 < fraction
  /// <= 1, with the tip at `position` [m] and `velocity` [m/s]. The scripted motion gives the tool's axis at this time.
  /// f_in is constant over the step. Costs a contact search and a force computation.
  virtual Vec3 force_at(double fraction, const Vec3& position, const Vec3& velocity) noexcept = 0;
  /// Returns a hash of the set of contacts that were rendered in the last call of force_at, or at the start of the
  /// step if force_at has not been called in this step. Equal sets have equal hashes. Costs about a nanosecond for
  /// each contact.
  virtual std::uint64_t contact_set() const noexcept { return 0; }
  /// Returns the Jacobian of the step's force. Precondition: force_at has not been called in this step.
  virtual ForceJacobian jacobian() const noexcept = 0;
};

/// Default time tolerance with which the integrator `event` locates contact onset and release [s].
inline constexpr double kEventTolerance = 1e-9;

struct SpringDamper;

/// An integrator: moves the tool under the forces of a step. Its stability and its energy error are documented at its
/// function in table.cpp.
/// The pointers step_matrix and stability_margin describe a step for one spring-damper (SpringDamper). They are null if
/// the integrator has no closed form; callers then evaluate steps of the integrator instead.
struct IntegratorEntry {
  ModelInfo info;
  /// Takes one step of dt [s]: moves position and velocity of the tool of `mass` [kg]. `force` [N] is the force at the
  /// start of the step, and `field` gives the force at other times and states. Does not change the axis, keeps no state
  /// between steps and allocates nothing. `tolerance` [s] is the time tolerance of `event`.
  void (*step)(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field, double tolerance);
  int order = 1;         ///< order of convergence on undamped springs
  int damped_order = 1;  ///< order of convergence with damping
  /// True if the force at the start of the step acts unchanged over the step (M dv = f dt). The work in the step then
  /// follows from this force and the displacement alone.
  bool holds_force = false;
  /// Returns the matrix A of one step, (x, v) -> A (x, v), with position x and velocity v.
  Eigen::Matrix2d (*step_matrix)(const SpringDamper&) = nullptr;
  /// Returns a margin that is positive if and only if a step is stable. Leapfrog: 4 - 2 lambda B dt / M -
  /// lambda K dt^2 / M.
  double (*stability_margin)(const SpringDamper&) = nullptr;
  /// Largest B dt / M of a damper without a spring for which a step is stable; infinite for implicit
  /// integrators.
  double damper_limit = std::numeric_limits<double>::infinity();
};

// The table. To add an integrator, define its entry in table.cpp or in a new file, and add two lines here.
extern const IntegratorEntry kLeapfrog;
extern const IntegratorEntry kVelocityVerlet;
extern const IntegratorEntry kRk4;
extern const IntegratorEntry kEvent;
extern const IntegratorEntry kImplicitEuler;
extern const IntegratorEntry kImplicitMidpoint;

inline constexpr std::array kIntegrators = {
    &kLeapfrog, &kVelocityVerlet, &kRk4, &kImplicitEuler, &kImplicitMidpoint, &kEvent,
};

/// A linear force on a mass: f = -stiffness x - damping v. `assumed` is the Jacobian that implicit integrators use; it
/// may differ from the derivatives of the force.
struct LinearForce {
  Mat3 stiffness = Mat3::Zero();  ///< [N/m]
  Mat3 damping = Mat3::Zero();    ///< [N s/m]
  ForceJacobian assumed;
};

/// Returns the matrix of one step of an integrator for a mass M under a linear force and a force that is held over the
/// step. The columns belong to the components of position [m] and velocity [m/s] before the step and of the held force
/// [N], the rows to position and velocity after the step.
Eigen::Matrix<double, 6, 9> step_map(const IntegratorEntry& integrator, double M, double dt, const LinearForce& force);

/// The linear system that defines the stability of an integrator (thesis section A.3): one spring-damper on a mass, M
/// x'' = -lambda (K x + B x'). Each step is a linear map of (x, v).
struct SpringDamper {
  double K = 0.0;       ///< stiffness [N/m]
  double B = 0.0;       ///< damping [N s/m]
  double M = 0.1;       ///< mass [kg]
  double dt = 0.0005;   ///< time step [s]
  double lambda = 1.0;  ///< factor on K and B, such as an eigenvalue of the stiffness tensor
  const IntegratorEntry* integrator = &kLeapfrog;

  /// Returns the matrix of one step, (x, v) -> A (x, v), from the integrator's closed form. Without a closed
  /// form, the columns are the results of steps from (1, 0) and (0, 1).
  Eigen::Matrix2d step_matrix() const;
  /// Returns (x, v) after one step from rest at x = 0, under a force of 1 N that is held over the step.
  Eigen::Vector2d input_step() const;
  /// Returns true if no eigenvalue of the step matrix lies outside the unit circle by more than rounding. Uses
  /// trace and determinant, because computed eigenvalues near -1 have an error of the square root of rounding.
  bool is_stable() const;
};

}  // namespace hapbench
