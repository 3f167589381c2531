#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>

#include "sim/core/types.hpp"
#include "sim/loop/force_algorithm.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// The force on the tool during one step, for integrators that need more than the force of the row.
class ForceField {
 public:
  virtual ~ForceField() = default;
  /// f_in + f_render [N] at the time t_k + part dt, 0 < part <= 1, with the tip at `position` [m] and `velocity` [m/s].
  /// The axis follows the script; f_in is held over the step, as a sampled device holds it. Costs a contact search and
  /// a rendered force.
  virtual Vec3 force_at(double part, const Vec3& position, const Vec3& velocity) noexcept = 0;
  /// The same number as long as the same contacts act: of the row, or since then of the last force_at. Costs about a
  /// nanosecond a contact.
  virtual std::uint64_t contact_set() const noexcept { return 0; }
  /// Jacobian of the row's force. Precondition: force_at has not been called in this step.
  virtual ForceJacobian jacobian() const noexcept = 0;
};

/// Default of the tolerance within which `event` finds the times of contact on and off [s].
inline constexpr double kEventTolerance = 1e-9;

struct SpringDamper;

/// An integrator: turns forces into motion. The functions in table.cpp document stability and energy.
/// The theory is that of one spring-damper; functions without a closed form are null, and callers then use steps of the
/// integrator itself.
struct IntegratorEntry {
  ModelInfo info;
  /// One step of dt [s]: moves position and velocity of the tool of `mass` [kg], on which `force` [N] acts at the row.
  /// Leaves the axis alone, keeps nothing for the next step and allocates nothing. `tolerance`: of `event`.
  void (*step)(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field, double tolerance);
  int order = 1;         ///< of convergence on undamped springs
  int damped_order = 1;  ///< of convergence with damping
  /// True if the row's force acts unchanged over the step (M dv = f dt), so that its work needs no other force.
  bool holds_force = false;
  /// The matrix A of (x, v) -> A (x, v).
  Eigen::Matrix2d (*step_matrix)(const SpringDamper&) = nullptr;
  /// Positive if and only if a step is stable (leapfrog: 4 - 2 lambda B dt / M - lambda K dt^2 / M).
  double (*stability_margin)(const SpringDamper&) = nullptr;
  /// The largest B dt / M of a damper without a spring at which a step is stable; of the implicit ones every value is.
  double damper_limit = std::numeric_limits<double>::infinity();
};

// The table. To add an integrator, define its entry in table.cpp or a new file, and add two lines here.
extern const IntegratorEntry kLeapfrog;
extern const IntegratorEntry kVelocityVerlet;
extern const IntegratorEntry kRk4;
extern const IntegratorEntry kEvent;
extern const IntegratorEntry kImplicitEuler;
extern const IntegratorEntry kImplicitMidpoint;

inline constexpr std::array kIntegrators = {
    &kLeapfrog, &kVelocityVerlet, &kRk4, &kImplicitEuler, &kImplicitMidpoint, &kEvent,
};

/// The linear system on which the stability of integrators is judged (thesis A.3): one spring-damper,
/// M x'' = -lambda (K x + B x'), under an integrator. Each step is a linear map of (x, v).
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
  /// True while no eigenvalue leaves the unit circle by more than rounding. By trace and determinant, because computed
  /// eigenvalues near -1 are off by the square root of rounding.
  bool is_stable() const;
};

}  // namespace hapbench
