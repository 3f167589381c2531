#pragma once

#include <array>
#include <string_view>

#include "sim/loop/force_algorithm.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// How forces become motion. Each has a header of its own, with its formula, order, stability and energy.
enum class Integrator { leapfrog, velocity_verlet, rk4, implicit_euler, implicit_midpoint };

inline constexpr std::array kIntegrators = {Integrator::leapfrog, Integrator::velocity_verlet, Integrator::rk4,
                                            Integrator::implicit_euler, Integrator::implicit_midpoint};

/// "leapfrog", "velocity_verlet", "rk4", "implicit_euler" or "implicit_midpoint".
std::string_view integrator_name(Integrator integrator) noexcept;

/// The force on the tool during one step, for integrators that need more than the force of the row.
class ForceField {
 public:
  virtual ~ForceField() = default;
  /// f_in + f_render [N] at the time t_k + part dt, 0 < part <= 1, with the tip at `position` [m] and `velocity` [m/s].
  /// The axis follows the script; f_in is held over the step, as a sampled device holds it. Costs a contact search and
  /// a rendered force.
  virtual Vec3 force_at(double part, const Vec3& position, const Vec3& velocity) noexcept = 0;
  /// Of the row's force. Precondition: nobody has called force_at in this step.
  virtual ForceJacobian jacobian() const noexcept = 0;
};

/// One step of dt [s] with any of them: moves position and velocity of the tool, on which `force` [N] acts at the
/// row. Leaves the axis alone. Allocates nothing.
void integrate(Integrator integrator, ToolState& tool, const Vec3& force, double mass, double dt,
               ForceField& field) noexcept;

}  // namespace hapbench
