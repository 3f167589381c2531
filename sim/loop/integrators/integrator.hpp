#pragma once

#include "sim/loop/force_algorithm.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// The force on the tool during one step, for integrators that need more than the force of the row.
class ForceField {
 public:
  virtual ~ForceField() = default;
  /// f_in + f_render [N] at the time t_k + part dt, 0 < part <= 1, with the tip at `position` [m] and `velocity` [m/s].
  /// The axis follows the script; f_in is held over the step, as a sampled device holds it. Costs a contact search and
  /// a rendered force.
  virtual Vec3 force_at(double part, const Vec3& position, const Vec3& velocity) noexcept = 0;
  /// Jacobian of the row's force. Precondition: force_at has not been called in this step.
  virtual ForceJacobian jacobian() const noexcept = 0;
};

/// How forces become motion. One object is the state of one run; the integrators there are stand in table.hpp, each in
/// a file of its own with its formula, order, stability and energy.
class Integrator {
 public:
  virtual ~Integrator() = default;
  /// Returns to t = 0: clears the state kept between steps.
  virtual void reset() noexcept {}
  /// One step of dt [s]: moves position and velocity of the tool of `mass` [kg], on which `force` [N] acts at the row.
  /// Leaves the axis alone. Allocates nothing.
  virtual void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept = 0;
};

}  // namespace hapbench
