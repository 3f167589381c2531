#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/simulation.hpp"

/// Linearises the forces on a scenario's tool that rests in contact.
namespace hapbench {

/// State of a run while the tool is in contact. From this state, linear_contact() searches for the equilibrium.
struct ContactState {
  /// Pose of the tool. If the handle moves the tool, `pose` has the true position of the handle, and not the position
  /// that the encoder measures.
  ToolPose pose;
  double time = 0.0;  ///< [s]
};

/// Returns the state of a recorded step.
inline ContactState contact_state(const StepRecord& record) noexcept {
  ContactState state{record.tool.pose, record.time};
  if (record.handle_moves_tool) state.pose.position = record.handle.position;
  return state;
}

/// Linearisation of a contact at the equilibrium, or at the given ContactState if no equilibrium was found.
struct ContactAtRest {
  LinearContact contact;
  bool is_equilibrium = false;  ///< false if the search did not converge: a surface too soft, or a force that jumps
};

/// Returns derivatives of the rendered force and of the hand's force at the equilibrium of the tool near `near`. Dry
/// friction, encoder, sensor noise, force stages and passivity controller are left out. The derivatives of the rendered
/// force with respect to position and velocity of the tool are central differences with relative errors of 1e-7. The
/// set of contacts is held constant: where a point begins to touch, the difference is one-sided. The force at each
/// position is the force on a tool that rests there: the proxy of a constraint-based law has come to rest. In a planar
/// scene, in which no force along z arises, the derivatives along z are 0.
///
/// The equilibrium is found by Newton's method, with the targets of the hand as at the time of `near`. Without an
/// equilibrium, the derivatives belong to the pose of `near`; a law whose force jumps when a point begins to touch need
/// not have an equilibrium. Returns nothing if the tool touches nothing at `near`, or if a force is not
/// finite.
std::optional<ContactAtRest> linear_contact(const CheckedScenario& scenario,
                                            const std::shared_ptr<const PointShell>& shell, const ContactState& near);

/// Converts a contact that was linearised with the stiffness K [N/m] and the damping B [N s/m] of `from` to K and B of
/// `to`: multiplies the contact's stiffness by K of `to` divided by K of `from`, and its damping by B of `to` divided
/// by B of `from`. Keeps the damping if B of `from` is 0.
LinearContact scaled(LinearContact contact, const RenderingConfig& from, const RenderingConfig& to);

/// Checks the stability of the loop of hand, device and contact at several values of a scenario field. The contact is
/// linearised near a given state of a run.
class ContactLoops {
 public:
  /// `near`: see linear_contact(). `is_stiffness`: true if the field is the stiffness K. At a K without an equilibrium
  /// (a surface too soft to hold the tool, or a force that jumps), the loop of a stiffness field uses the last contact
  /// that was found, converted to this K by scaled(). `at_any_pose`: true if the first contact need not be an
  /// equilibrium.
  ContactLoops(const ContactState& near, bool is_stiffness, bool at_any_pose)
      : near_(near), is_stiffness_(is_stiffness), at_any_pose_(at_any_pose) {}

  /// Returns true if the loop of the scenario is stable. Returns nothing if there is no contact to linearise, or if
  /// contact_loop() is empty. The loop of a stiffness field may drift: with a real eigenvalue, the tool leaves an
  /// equilibrium, such as the top of a dome, at any K. Such drifts do not count if they are slower than any vibration
  /// above kVibrationCutoff in the first call. No K is a limit for such a drift.
  std::optional<bool> is_stable(const Scenario& scenario, const NamedFiles& files,
                                const std::shared_ptr<const PointShell>& shell);

 private:
  ContactState near_;
  bool is_stiffness_, at_any_pose_;
  /// The last contact that was found. It has the stiffness K and the damping B of known_rendering_.
  std::optional<LinearContact> known_;
  RenderingConfig known_rendering_;
  std::optional<bool> ignores_drift_;  ///< true if drifts do not count; empty before the first call of is_stable()
};

/// Sequence of values of a scenario field, for the search for the field's linear limit: the value at which the
/// linearised loop becomes unstable.
struct LimitWalk {
  double start = 0.0;
  /// Returns the next value above `value` if `up` is true, otherwise the next value below. At the end of the range,
  /// returns `value` itself.
  std::function<double(double value, bool up)> next = {};
  /// Returns true if the interval is small enough to end the bisection.
  std::function<bool(double stable, double unstable)> is_resolved = {};
};

/// Searches the linear limit. Steps up from a stable start to an unstable value, or down from an unstable start to a
/// stable value. Then bisects. Returns the largest stable value before the first unstable value; infinity if all values
/// above a stable start are stable, minus infinity if no value is stable. Returns nothing if `is_stable` returns
/// nothing at the start. A later value for which `is_stable` returns nothing counts as unstable.
std::optional<double> limit_along(const LimitWalk& walk, const std::function<std::optional<bool>(double)>& is_stable);

/// Returns the largest stiffness K [N/m] at which the loop of hand, device and contact is stable, searched from the
/// scenario's K in steps of 10 %, up to twice this K and down to a billionth of it. Infinite if the loop is stable up
/// to twice K; 0 if no K is stable. At each K, the contact is linearised at the equilibrium of the tool near `near`. If
/// a K has no equilibrium, the loop uses the last contact that was found, converted to this K by scaled(). Empty if
/// has_linear_loop() is false or the tool touches nothing at `near`. Slow drifts do not count as unstable
/// (ContactLoops::is_stable()).
std::optional<double> linear_stiffness_limit(const CheckedScenario& scenario,
                                             const std::shared_ptr<const PointShell>& shell, const ContactState& near);

}  // namespace hapbench
