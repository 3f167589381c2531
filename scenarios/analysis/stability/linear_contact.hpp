#pragma once

#include <memory>
#include <optional>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/stability/run_end_observer.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "sim/geometry/point_shell.hpp"

/// Linearisation of a scenario's tool that rests in contact.
namespace hapbench {

/// The linearisation at the pose where the search for the equilibrium ended.
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
/// equilibrium, the derivatives belong to the last pose of the search; a law whose force jumps when a point begins to
/// touch need not have an equilibrium. Returns nothing if the tool touches nothing at `near`, or if a force is not
/// finite.
std::optional<ContactAtRest> linear_contact(const CheckedScenario& scenario,
                                            const std::shared_ptr<const PointShell>& shell, const ContactState& near);

}  // namespace hapbench
