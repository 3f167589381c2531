#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Estimates discretization errors of the metrics of a comparison, from runs with smaller time steps and finer point
/// spacing.
namespace hapbench {

/// Error estimate of a metric, in the metric's unit. `step` and `spacing` are the errors due to the time step and to
/// the point spacing. Each is the error at the coarsest of three levels (convergence_of).
struct KnownError {
  /// Empty if the refinement is impossible, or if a refined run lacks the metric or has another outcome than the run of
  /// the comparison.
  std::optional<double> step, spacing;
  bool has_points = true;  ///< false if the scene has no point spacing to refine
  /// Error of computing the metric in one run, such as the error of a quantile from a histogram.
  double tolerance = 0.0;

  /// Returns the sum of `step`, `spacing` and `tolerance`. Empty if `step` is empty, or if the scene has a point
  /// spacing and `spacing` is empty.
  std::optional<double> sum() const;
};

/// The runs of a comparison, repeated with refined time steps and refined point spacing.
class FinerRuns {
 public:
  /// Makes all refined runs, without result files. `reports`: the results of the runs of `comparison`, in the same
  /// order. `comparison` and `reports` must outlive this object. Throws Stopped.
  FinerRuns(const Comparison& comparison, std::span<const Result> reports, const JobOptions& jobs);

  /// Returns the error estimate of a metric of run number `run` of the comparison. Metrics of refined runs are sampled
  /// at the times of the original run's steps.
  KnownError known_error(std::size_t run, const std::string& metric) const;

  /// Returns a clause about the refinements of time step and point spacing of a scene: for each refinement, the values
  /// of its levels, or the reason why the refinement was not made.
  std::string refined(std::size_t scene) const;

 private:
  /// The refinement of one field in one scene.
  struct Part {
    LevelSweep levels = {};
    std::size_t first = 0;     ///< index in finer_ of the first refined run
    std::string why_not = {};  ///< why no refinement was made; empty if a refinement was made
  };
  struct Scene {
    Part step, spacing;
    bool has_points;
  };
  std::optional<double> error_by(const Part& part, std::size_t run, const std::string& metric) const;

  const Comparison& comparison_;
  std::span<const Result> reports_;
  std::vector<Scene> scenes_;
  /// Refined runs, sorted by scene, then by refinement, then by level, then in the order of the runs in the comparison.
  std::vector<Result> finer_;
};

}  // namespace hapbench
