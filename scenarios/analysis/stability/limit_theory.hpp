#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/limit_question.hpp"
#include "scenarios/analysis/stability/run_end_observer.hpp"

/// Stability limits of a field from linear theory, without runs. One evaluation costs about a thousandth of a run.
namespace hapbench {

/// Returns the limit that stands for a range without a stable-to-unstable transition. If it is stable to its end:
/// infinity, or 0 in a search for the smallest stable value. If no value is stable: 0, or infinity.
double limit_without_transition(bool is_stable, bool smallest);

/// Limit of a stability condition, found in the range of a LimitQuestion.
struct TheoreticalLimit {
  /// Last stable value before the first stable-to-unstable transition. limit_without_transition() if the condition
  /// holds to the end of the range; empty if it does not apply to the scene or no value is stable.
  std::optional<double> value = {};
  /// Midpoints of all contiguous intervals of stable parameters. field_limit() also runs these parameters, because
  /// its coarser scan could miss a narrow interval.
  std::vector<double> islands = {};
  bool has_none = false;  ///< true if the condition applies and no value is stable
};

/// Returns the limit up to which all eigenvalues of the linear map of one time step lie inside the unit circle. Applies
/// to springs in permanent contact if the loop of tool, hand and device is linear.
TheoreticalLimit eigenvalue_limit(const LimitQuestion& question);

/// Returns the same limit as eigenvalue_limit(), but with dry friction, encoder step and force step of an impedance
/// device set to zero.
TheoreticalLimit frictionless_limit(const LimitQuestion& question);

/// Returns the limit by the integrator's stability inequality. Applies to springs in permanent contact with a tool
/// without hand and device.
TheoreticalLimit inequality_limit(const LimitQuestion& question);

/// Returns the limit of the question's field by the eigenvalues of the loop of hand, device and a permanent contact. At
/// each value of the field, the contact has the derivatives of the rendered force at the equilibrium of the tool
/// (linear_contact). `near` is the state of a run in which the field has the value `stable`; the search for the
/// equilibrium starts from `near`, and the search for the limit starts at `stable`. Returns infinity if the loop is
/// stable at all values of the range above `stable`, zero if it is stable at no value. Returns nothing if the tool has
/// no equilibrium in contact at `stable`, or if has_linear_loop() is false.
std::optional<double> contact_limit(const LimitQuestion& question, double stable, const ContactState& near);

/// Limits of the stiffness K [N/m] for an impedance device at a two-sided wall, that is, with springs in permanent
/// contact (has_permanent_springs).
struct WallLimits {
  /// Limits by the closed forms of stiffness_limits(), in their order; an entry is empty if its form does not apply.
  /// The list is empty if wall_limits() does not apply.
  std::vector<std::optional<double>> closed_forms = {};
  std::optional<double> worst_hand = {};  ///< smallest limit over the hands of typical_hands()
  std::string no_theory = {};             ///< why the eigenvalues of the loop give no limit; empty if they give a limit
};
/// Returns the limits of K. Applies if the question asks for the largest stable K of an impedance device at a two-sided
/// wall and the damping does not depend on K. Otherwise returns empty limits.
WallLimits wall_limits(const LimitQuestion& question);

}  // namespace hapbench
