#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/limit_question.hpp"

/// Limits of a field that theory gives, without runs. An evaluation costs about a thousandth of a run.
namespace hapbench {

/// The limit by a condition on the scene, along the whole range of a question.
struct TheoreticalLimit {
  /// The last stable value before the first transition. Infinite (smallest: 0) if the whole range is stable; empty
  /// where the condition does not apply to the scene or nothing is stable.
  std::optional<double> value = {};
  /// The middles of all contiguous intervals of stable parameters. Runs evaluate them too, since an interval may lie
  /// between two values of their scan.
  std::vector<double> islands = {};
  bool has_none = false;  ///< the condition applies, and no value is stable
};

/// Returns the limit by the eigenvalues of a step, for springs that stay in contact with a tool that is alone, or with
/// a device whose loop is linear.
TheoreticalLimit eigenvalue_limit(const LimitQuestion& question);

/// Returns the limit by the integrator's inequality, for springs that stay in contact with a tool that is alone.
TheoreticalLimit inequality_limit(const LimitQuestion& question);

/// Returns the limit by the eigenvalues of the loop of device, hand and a surface of the stiffness K `lambda` while
/// they touch; infinite if the whole range is stable, empty without a device.
std::optional<double> contact_limit(const LimitQuestion& question, double lambda);

/// Limits of K on a wall that holds the handle of an impedance device from both sides.
struct WallLimits {
  /// The values of stiffness_limits(), in their order; empty if the question is another one.
  std::vector<std::optional<double>> closed_forms = {};
  std::optional<double> worst_hand = {};  ///< smallest limit over hand_family() in place of the scene's hand
  std::string no_theory = {};             ///< why the eigenvalues of the loop do not give a limit; empty if they do
};
WallLimits wall_limits(const LimitQuestion& question);

}  // namespace hapbench
