#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/limit_question.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"

/// Stability limits: the largest or smallest value of a scenario's field at which the run of the scenario is stable
/// (run_stability.hpp).
namespace hapbench {

/// A value of the field, and the verdict on the run with this value.
struct JudgedValue {
  double value = 0.0;
  RunVerdict verdict = RunVerdict::stable;
};

/// An end of the interval of stable values.
struct IntervalEnd {
  std::optional<double> value;        ///< outermost stable value; empty if no run is stable
  std::optional<JudgedValue> beyond;  ///< nearest unstable value beyond it; empty if the end of the range is stable

  /// Returns |beyond - value|: the limit lies between the two. Empty if one of them is empty.
  std::optional<double> tolerance() const;
};

/// The result of a search for a stability limit.
struct FieldLimit {
  IntervalEnd end;    ///< the limit: the end of the interval that the question asks for
  IntervalEnd other;  ///< the other end of the interval
  /// Linear limit by the eigenvalues of a step, for springs that stay in contact. If the whole range is stable, it is
  /// infinite, or 0 in a search for the smallest stable value. Empty if the theory does not apply or no value is
  /// stable.
  std::optional<double> theory;
  bool theory_has_none = false;  ///< true if the theory applies and no value of the range is stable
  /// Limit by the integrator's stability inequality, for a tool without hand and device on springs; empty otherwise.
  std::optional<double> closed_form;
  /// Linear limit of a device on a surface that can be left, if `theory` is empty: the stability limit of the loop of
  /// device, hand and a permanent contact with the stiffness rendered at the simulated limit. Dry friction and the
  /// encoder are ignored. Because of them, and because the contact may be lost, the simulated limit can be higher
  /// than this limit. Infinite if the whole range is stable.
  std::optional<double> linear;
  /// WallLimits::closed_forms [N/m].
  std::vector<std::optional<double>> closed_forms;
  std::optional<double> worst_hand;  ///< WallLimits::worst_hand [N/m]
  std::string no_theory;             ///< WallLimits::no_theory
  SettledState settled;              ///< contacts and vibration at the end of the run at the limit
  std::optional<JudgedValue> own;    ///< the run at the scenario's value; empty if the value is outside of the range
  /// True if the loop of hand and device is unstable without contact (unstable_without_contact()) at the nearest
  /// value beyond the limit, or at the smallest evaluated value if there is no limit.
  bool unstable_alone = false;
  bool has_effect = true;         ///< false if the handle's motion is bitwise equal in all runs
  std::size_t tried_between = 0;  ///< number of verification samples in the interval, all stable
  bool scattered = false;  ///< true if stable values exist, but no contiguous interval of stable values is as long as
                           ///< kNearLimit
  std::vector<JudgedValue> runs;          ///< all runs, by increasing value
  std::vector<JudgedValue> inconsistent;  ///< unstable runs inside the interval and stable runs outside of it
  std::size_t undecided = 0;              ///< number of runs that were too short to judge (RunStability::undecided)

  /// Returns true if the simulated limit exceeds `linear` by more than the fraction `resolution`. At the stable
  /// values beyond `linear`, contact is intermittent, so `linear` is the limit to quote.
  bool is_beyond_linear(double resolution) const;
  /// Returns the linear limit: `theory` if it has a value, otherwise `linear`.
  const std::optional<double>& linear_edge() const { return theory ? theory : linear; }
};

/// Finds a stability limit. First evaluates 17 equidistant parameters of the range, the scenario's value, and the
/// middles of the intervals that are stable in theory. Then searches the interval with find_verified_interval, or
/// with find_stable_interval (argument `beside`) if LimitQuestion::between is false. Makes 35 to 120 runs, and up to
/// 56 more for each verification that fails. Throws InputError, with the file, if the stability rule limits vibration
/// and the sampling rate is 60 Hz or less.
FieldLimit field_limit(const LimitQuestion& question);

}  // namespace hapbench
