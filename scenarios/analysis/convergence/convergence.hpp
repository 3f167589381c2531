#pragma once

#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/batch/number_with_error.hpp"

/// How far a number is from converged in a scene's step or any field: observed order, Richardson's value and grid
/// convergence index (Roache 1994; ASME V&V 20) at levels h, h/r, h/r^2, … of the field; or why no order can be stated.
namespace hapbench {

inline constexpr const char* kStepPath = "time.step_s";

/// The levels of a scene's field, from the scenario's own value to finer ones.
struct LevelSweep {
  Axis axis;                  ///< the field's values, with what has to change along with them
  double ratio = 2.0;         ///< of each value to the next
  double formal_order = 2.0;  ///< of the integrator, or of whatever a distance between points or of a grid approximates
  std::string no_order = {};  ///< why no metric of this scene can have an order; empty otherwise
};

/// With shorter steps the run lasts as long, delays of devices keep their length, and metrics of motion, force and
/// contact are taken at the times of the coarsest rows. A mesh without a spacing begins with the mean distance of its
/// vertices. Throws InputError when the field is not a number > 0 or an integer, and for a ratio of steps that is not
/// whole.
LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio);

/// What a run at one level gave.
struct LevelResult {
  std::string setting;           ///< the field's value, for reasons
  std::string outcome;           ///< how the run ended
  std::optional<double> result;  ///< empty where the run failed or has no such number
  /// Counts of contacts, by name; where they differ between levels, contacts have switched.
  std::vector<std::pair<std::string, double>> contacts = {};
  std::uint64_t state_hash = 0;  ///< equal for runs that are the same, bit for bit
};

/// The verdict on a metric.
struct Convergence {
  std::optional<double> order;         ///< observed at the three finest levels; empty where none is credible
  std::string reason;                  ///< why there is none, in a clause; empty with an order
  std::optional<double> extrapolated;  ///< Richardson's value; only with an order, as the next two
  std::optional<double> gci;           ///< of the finest level, relative to its result; empty where that is 0
  /// GCI_21 / (r^p GCI_32) is 1 within 0.1 at the three finest levels, and where a fourth one counts with the same p at
  /// the three before.
  bool asymptotic = false;
  /// Least and largest result of the last three levels that count, or of two; none with fewer.
  std::optional<std::pair<double, double>> band;
  /// The observed order of each level over it and the two coarser levels, if defined.
  std::vector<std::optional<double>> orders;
  /// The estimated error of each level [metric's unit], no bound: with an order 1.25 |f - f*|, at the finest level its
  /// GCI; otherwise the largest distance to a finer level, and at least the width of the band.
  std::vector<std::optional<double>> errors;
};

/// What the run of a level gave of a metric; no result where it has none or diverges.
LevelResult level_result(const LevelSweep& levels, std::size_t level, const Result& summary, const std::string& metric);

/// Judges the results of all levels. Those count that follow the last one that ended otherwise than the finest or has
/// no result. No order is stated where all runs are the same; for the reason that the levels have (`no_order`); with
/// fewer than three that count; where contacts switch between the last three or the last two differ by rounding only;
/// where within the last four differences change their sign or an order is not in (0, 2 formal].
Convergence convergence_of(const LevelSweep& sweep, std::span<const LevelResult> levels);

/// The cases at the levels behind the first. Throws InputError where one of them cannot be run.
Cases finer_cases(const LevelSweep& levels, const Cases& cases);

/// Error of a number, in its unit: by step and by spacing the error of the coarsest of three levels (convergence_of).
struct KnownError {
  std::optional<double> step, spacing;  ///< empty where a finer run ends otherwise or has no such number
  bool has_points = true;               ///< false: there is no spacing to be halved
  double tolerance = 0.0;               ///< of the metric itself, as that of a quantile of a histogram

  /// The whole error; empty if a part that can be known is not.
  std::optional<double> sum() const {
    if (!step || (has_points && !spacing)) return std::nullopt;
    return *step + spacing.value_or(0.0) + tolerance;
  }
};

/// The runs of a comparison again, by step and by spacing.
class FinerRuns {
 public:
  /// Runs them, without files. `reports` are those of `comparison`; both have to outlive this. Throws Stopped.
  FinerRuns(const Comparison& comparison, std::span<const Result> reports, const JobOptions& jobs);

  /// Error of a metric of the run with that number in the comparison; metrics are taken at the times of its own rows.
  KnownError known_error(std::size_t run, const std::string& metric) const {
    const auto& [step, spacing, has_points] = scenes_[comparison_.scene(run)];
    KnownError known{error_by(step, run, metric), error_by(spacing, run, metric), has_points};
    if (const Metric* found = find_metric(reports_[run].metrics, metric))
      known.tolerance = found->tolerance().value_or(0.0);
    return known;
  }

  /// What was refined of a scene, and why something was not, in a clause.
  std::string refined(std::size_t scene) const;

 private:
  struct Part {
    LevelSweep levels = {};
    std::size_t first = 0;     ///< number of the first finer run
    std::string why_not = {};  ///< why there are no levels; empty otherwise
  };
  struct Scene {
    Part step, spacing;
    bool has_points;
  };
  std::optional<double> error_by(const Part& part, std::size_t run, const std::string& metric) const;

  const Comparison& comparison_;
  std::span<const Result> reports_;
  std::vector<Scene> scenes_;
  std::vector<Result> finer_;  ///< by part, then by level, then as in the comparison
};

/// Places of numbers in the order that their errors leave.
struct HeldOrder {
  /// Each number of a group is less (is_less()) than every number of the groups behind it.
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> unplaced;  ///< numbers that are apart from no other, where others are
};

/// Numbers without a value or an error have no place.
HeldOrder held_order(std::span<const NumberWithError> numbers);

/// The same in a sentence about named numbers: "the order holds: mean < proxy".
std::string held_text(std::span<const NumberWithError> numbers, std::span<const std::string> names);

}  // namespace hapbench
