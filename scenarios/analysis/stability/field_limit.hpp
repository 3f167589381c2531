#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/limit_question.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"

/// Stability limits: the largest or smallest value of a scenario's field at which its run is stable
/// (run_stability.hpp).
namespace hapbench {

/// A value and the verdict on the run with it.
struct JudgedValue {
  double value = 0.0;
  RunVerdict verdict = RunVerdict::stable;
};

/// An end of the interval of stable values.
struct IntervalEnd {
  std::optional<double> value;        ///< the last stable value; empty if no run is stable
  std::optional<JudgedValue> beyond;  ///< the first unstable value beyond it; empty if the range ends stable

  /// Returns how far beyond the value the limit may lie: the distance to the first unstable value; empty without one.
  std::optional<double> tolerance() const;
};

/// The answer to a question for a limit.
struct FieldLimit {
  IntervalEnd end;    ///< the limit: the end of the interval that the question asks for
  IntervalEnd other;  ///< the other end of the interval
  /// Linear limit by the eigenvalues of a step, where the springs stay in contact; infinite (smallest: 0) if the whole
  /// range is stable, empty where there is no theory or nothing is stable.
  std::optional<double> theory;
  bool theory_has_none = false;  ///< by theory no value of the range is stable
  /// Limit by the integrator's inequality, where the tool is alone with the springs; empty where it has none.
  std::optional<double> closed_form;
  /// Linear limit of a device at a surface that only pushes, where there is no theory: the limit of the loop of device,
  /// hand and the stiffness rendered at the simulated limit, while contact lasts, without dry friction and encoder.
  /// Friction, encoder and lost contact hold up a simulated limit beyond it. Infinite if the whole range is stable.
  std::optional<double> linear;
  /// Limits of K on a wall that holds the handle of an impedance device from both sides (WallLimits); empty elsewhere.
  std::vector<std::optional<double>> closed_forms;
  std::optional<double> worst_hand;
  std::string no_theory;
  SettledState settled;            ///< of the run at the limit
  std::optional<JudgedValue> own;  ///< the run at the scenario's current value, if that is in the range
  /// unstable_without_contact() at the first value beyond the limit, or without a limit at the first value of the
  /// range.
  bool unstable_alone = false;
  bool has_effect = true;                 ///< false if the handle moved alike, bit for bit, in all runs
  std::size_t tried_between = 0;          ///< verification samples between the ends of the interval, all stable
  bool scattered = false;                 ///< there are stable values, but no contiguous stable interval of kNear
  std::vector<JudgedValue> runs;          ///< all, by value
  std::vector<JudgedValue> inconsistent;  ///< runs that are unstable in the interval, or stable outside of it
  std::size_t undecided = 0;              ///< runs that were too short to judge (RunStability::undecided)

  /// Returns true if the limit lies beyond `linear` by more than this relative distance. Contact at stable values
  /// beyond `linear` is intermittent, so that `linear` is the limit to quote.
  bool is_beyond_linear(double resolution) const;
  /// Returns the linear limit: `theory`, or else `linear`.
  const std::optional<double>& linear_edge() const { return theory ? theory : linear; }
};

/// Answers a question: evaluates 17 values, the scenario's current value and the middles of intervals that are stable
/// in theory, then searches the interval (find_edge with `beside`, or find_tried_edge for LimitQuestion::between).
/// Makes 35 to 120 runs; verification takes 56 more each time that it fails. Throws InputError, with the file, if the
/// rule limits vibration and the sampling rate is 60 Hz or less.
FieldLimit field_limit(const LimitQuestion& question);

}  // namespace hapbench
