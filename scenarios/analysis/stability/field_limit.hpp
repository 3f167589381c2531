#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/convergence/metric_errors.hpp"
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
  std::optional<double> value;  ///< outermost stable value; empty if no stable interval was found
  /// Nearest unstable value beyond `value`; empty if the end of the range is stable.
  std::optional<JudgedValue> beyond;

  /// Returns |beyond - value|: the limit lies between `value` and `beyond`. Returns nothing if `value` or `beyond` is
  /// empty.
  std::optional<double> tolerance() const;
};

/// The value of a stability limit that the program reports as usable; see quoted_limit().
struct QuotedLimit {
  std::optional<double> value = {};
  std::string reason = {};  ///< why the limit has this value, or why no value can be quoted
};

/// The result of a search for a stability limit.
struct FieldLimit {
  QuotedLimit quoted = {};
  /// The limit: the high end of the stable interval, or the low end in a search for the smallest stable value.
  IntervalEnd end;
  IntervalEnd other;          ///< the other end of the interval
  bool beyond_fades = false;  ///< RunStability::fades of the run at `end.beyond`
  /// Linear limit for springs that stay in contact, by the eigenvalues of the linear map of one time step
  /// (eigenvalue_limit()). If the loop is stable to the end of the range, it is infinite, or 0 in a search for the
  /// smallest stable value. Empty if the theory does not apply or no value is stable.
  std::optional<double> theory;
  bool theory_has_none = false;  ///< true if the theory applies and no value of the range is stable
  /// Limit by the integrator's stability inequality (inequality_limit()), which applies to a tool on springs without
  /// hand and device; empty otherwise.
  std::optional<double> closed_form;
  /// Linear limit if `theory` is empty. For springs in permanent contact, it is frictionless_limit(). For a surface
  /// that the tool can leave, it is contact_limit(), searched from the run with the largest stable value in which
  /// contact lasts. Dry friction and the encoder are ignored. Dry friction, the encoder and loss of contact can raise
  /// the simulated limit above the linear limit. Without a transition in the range: limit_without_transition().
  std::optional<double> linear;
  /// Why no linear limit was found; empty if `theory` or `linear` has a value, or if the theory finds no stable value.
  std::string no_linear = {};
  /// Error estimates of the bounded metrics (metric_errors()): the largest error at any end of a stable interval that
  /// the repeated searches found.
  MetricValues metric_errors = {};
  /// True if a bounded metric with its error added violates its bound at an end of the interval, even after four
  /// repeated searches.
  bool violates_with_errors = false;
  /// WallLimits::closed_forms [N/m].
  std::vector<std::optional<double>> closed_forms;
  std::optional<double> worst_hand;  ///< WallLimits::worst_hand [N/m]
  std::string no_theory;             ///< WallLimits::no_theory
  SettledState settled;              ///< settled state of the run at the limit
  /// Name of the part that is unstable without contact, such as "hand and device"; empty if `unstable_alone` is false.
  std::string unstable_part = {};
  /// Verdict at the scenario's current value; empty if this value is outside of the range.
  std::optional<JudgedValue> own;
  /// True if the loop of hand and device is unstable without contact (unstable_without_contact()) at the nearest
  /// value beyond the limit, or at the smallest evaluated value if there is no limit.
  bool unstable_alone = false;
  bool has_effect = true;  ///< false if the handle's motion is bitwise equal in all runs
  /// Number of distinct values between the ends of the interval that were run to verify it; all of them are stable.
  std::size_t tried_between = 0;
  /// True if the field is whole and all values of the stable interval were run.
  bool tried_all = false;
  /// True if stable values exist, but no contiguous stable interval is as long as kNearLimit times the limit.
  bool scattered = false;
  bool scattered_at_current = false;      ///< StableInterval::scattered_at_current
  std::vector<JudgedValue> runs;          ///< all runs, by increasing value
  std::vector<JudgedValue> inconsistent;  ///< unstable runs inside the interval and stable runs outside of it
  std::size_t undecided = 0;              ///< number of runs that were too short to judge (RunStability::undecided)

  /// Returns the linear limit: `theory` if it has a value, otherwise `linear`.
  const std::optional<double>& known_linear_limit() const { return theory ? theory : linear; }
  /// If the simulated limit is quoted, returns the width of the interval that encloses it. If the linear limit is
  /// quoted, returns nothing, because the linear limit is known to many digits.
  std::optional<double> quoted_tolerance() const { return quoted.value == end.value ? end.tolerance() : std::nullopt; }
};

/// Finds a stability limit. First runs 17 values of the field, the scenario's value, and the middle of each interval
/// that is stable in theory. The 17 values divide the range, or the range of their logarithms, into equal parts. If
/// none is stable, makes up to 60 runs between neighbours that fail in different ways. Then searches the ends of the
/// interval of stable values: with find_verified_interval() if LimitQuestion::between is set, otherwise with
/// find_stable_interval(), with its argument `beside` true. Makes 35 to 120 runs; each failed verification costs up to
/// 56 more. The metrics keep their bounds even with their errors at the limit added, as in `tune`: if a metric plus its
/// error violates a bound, searches again with bounds that are tightened by these errors. Throws InputError, with the
/// file, if the rule limits vibration and the sampling rate is 60 Hz or less.
FieldLimit field_limit(const LimitQuestion& question);

}  // namespace hapbench
