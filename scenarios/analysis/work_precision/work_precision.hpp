#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/work_precision/sampled_motion.hpp"
#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/batch/run_cost.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// Work-precision studies: the discretisation error of integrators and time steps, and their cost.
///
/// A problem is a scene with given values of all fields except integrator and time step. Two force laws give two
/// problems, because they have different solutions. The error of a setting is the difference from the reference
/// solution of the same problem, at times that all settings share. The reference solution is a converged solution by
/// rk4. If rk4 is also the integrator of settings, a solution by velocity_verlet checks the reference solution.
namespace hapbench {

/// Inputs of work_precision().
struct WorkPrecisionQuestion {
  ScenarioText scenario;
  std::vector<std::string> overrides = {};  ///< overrides for all runs, as in --set
  /// Fields that vary. The axis `integrator.type` gives the curves of a problem, every other axis gives problems.
  std::vector<Axis> over = {};
  std::size_t levels = 4;   ///< number of different time steps; the largest is the time step of the scenario
  double ratio = 2.0;       ///< ratio of two neighbouring time steps; an integer
  double max_error = 1e-6;  ///< requested error: rms error of the tip's position [m]
};

/// A reference solution uses a time step that is at least this factor smaller than the smallest step of the settings.
inline constexpr double kReferenceRefinement = 16.0;
/// An error is resolved if it is at least this factor larger than the error of the reference solution.
inline constexpr double kResolvedError = 10.0;
/// Initial shift [m] whose growth shows whether the trajectory of a problem can be predicted.
inline constexpr double kInitialShift = 1e-9;

/// An integrator with a time step.
struct WorkPrecisionSetting {
  std::string problem;     ///< values of the axes that define the problem, such as the name of the law
  std::string integrator;  ///< name of the integrator
  double step_s = 0.0;     ///< time step [s]
  Outcome outcome = {};    ///< outcome of the run, or of the first of several trials
  /// True if the scenario expects the outcome. The error of a run with another outcome has no meaning: a tool that does
  /// not move has a small error.
  bool is_expected = true;
  /// Difference from the reference solution. Empty if the problem is not predictable, if the reference solution has no
  /// error, or if the run ended otherwise than its reference.
  std::optional<MotionDifference> error = {};
  /// Error of the reference solution; empty if the runs for the reference solution ended differently.
  std::optional<MotionDifference> reference_error = {};
  RunCost cost = {};
  /// True if the setting is on the Pareto front of the problem (mark_front()).
  bool on_front = false;
  bool is_knee = false;  ///< true for the knee of the front (pareto_front.hpp)

  /// Returns true if the position error is known and resolved. The outcome does not matter.
  bool is_resolved() const { return error && error->position >= kResolvedError * reference_error->position; }

  // Bounds of the position error [m] by the triangle inequality. Precondition: the setting has an error.
  double largest_error() const { return error->position + reference_error->position; }
  double smallest_error() const { return std::max(error->position - reference_error->position, 0.0); }
};

/// A problem with its settings, ordered by integrator, then by decreasing time step.
struct WorkPrecisionProblem {
  std::string name;
  std::string reference = {};  ///< description of the reference solution
  /// Rms distance [m] between two runs with the smallest time step whose starting positions are kInitialShift apart.
  double grown_shift = 0.0;
  /// Reason why runs with other time steps have another noise, so that their differences are no errors
  /// (LevelSweep::no_order); empty if they have not.
  std::string noise = {};
  bool is_predictable = true;  ///< true without such a noise, and if grown_shift is at most the requested error
  std::vector<WorkPrecisionSetting> settings = {};

  /// Returns the cheapest setting with an expected outcome whose largest_error() is at most `max_error`; null if no
  /// setting has both.
  const WorkPrecisionSetting* cheapest_below(double max_error) const;
  /// Returns the cheapest setting with an expected outcome whose smallest_error() is at most `max_error`; null if no
  /// setting has both. The position error of this setting may exceed `max_error`.
  const WorkPrecisionSetting* cheapest_possibly_below(double max_error) const;
};

/// Marks the Pareto front of the settings of a problem, and its knee. A setting is on the front if its error is
/// resolved and its outcome is expected, and if no other setting with an expected outcome is both cheaper and more
/// accurate. An unresolved error of another setting counts as its largest_error(). Unresolved settings are not on the
/// front, because their order is unknown.
void mark_front(std::vector<WorkPrecisionSetting>& settings);

/// Runs all settings, their reference solutions and the measurements of cost. The measurements run one at a time,
/// everything else in parallel. Throws InputError before anything runs, and Stopped.
std::vector<WorkPrecisionProblem> work_precision(const WorkPrecisionQuestion& question, const JobOptions& jobs);

}  // namespace hapbench
