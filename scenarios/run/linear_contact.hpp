#pragma once

#include <memory>
#include <optional>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/simulation.hpp"

/// Linearisation of a scenario's tool that rests in contact.
namespace hapbench {

/// A state of a run in contact, from which linear_contact() searches the equilibrium.
struct ContactState {
  ToolPose pose;      ///< pose of the tool; true position of the handle if the handle moves the tool
  double time = 0.0;  ///< [s]
};

/// Returns the state of a recorded step.
inline ContactState contact_state(const StepRecord& record) noexcept {
  ContactState state{record.tool.pose, record.time};
  if (record.handle_moves_tool) state.pose.position = record.handle.position;
  return state;
}

/// The linearisation at the equilibrium; without an equilibrium, at the pose of the run.
struct ContactAtRest {
  LinearContact contact;
  bool is_equilibrium = false;  ///< false if the search did not converge: a surface too soft, or a force that jumps
};

/// Returns derivatives of the rendered force and of the hand's force at the equilibrium of the tool near `near`,
/// without dry friction, encoder, noise, and force stages. The derivatives of the rendered force are central
/// differences with respect to position and velocity of the tool, relative errors 1e-7. The set of contacts is held
/// constant: where a point begins to touch, the difference is one-sided.
///
/// The equilibrium is found by Newton's method, with the targets of the hand as at the time of `near`. Without an
/// equilibrium, the derivatives belong to the pose of `near`; a law whose force jumps when a point begins to touch need
/// not have an equilibrium. Returns nothing if the tool touches nothing at `near`, or if a force is not
/// finite.
std::optional<ContactAtRest> linear_contact(const CheckedScenario& scenario,
                                            const std::shared_ptr<const PointShell>& shell, const ContactState& near);

/// Converts a contact that was linearised with the stiffness K and damping B of `from` to the K and B of `to`: its
/// stiffness is proportional to K, and its damping to B.
LinearContact scaled(LinearContact contact, const RenderingConfig& from, const RenderingConfig& to);

/// Returns the largest stiffness K [N/m] at which the loop of hand, device and contact is stable. The search starts at
/// the scenario's K and uses steps of 10 %, up to twice this K and down to a billionth of it. Returns infinity if the
/// loop is stable up to twice K, and 0 if no K is stable. At each K, the contact is linearised at the equilibrium of
/// the tool near `near`. If there is no equilibrium at a K, the latest contact found is used, scaled(). Empty without
/// has_linear_loop(), and if the tool touches nothing at `near`.
std::optional<double> linear_stiffness_limit(const CheckedScenario& scenario,
                                             const std::shared_ptr<const PointShell>& shell, const ContactState& near);

}  // namespace hapbench
