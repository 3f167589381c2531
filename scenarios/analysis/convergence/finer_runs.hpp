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

/// The errors of the numbers of a comparison, by runs with a finer step and a finer spacing of the points.
namespace hapbench {

/// Error of a number, in its unit: by step and by spacing the error of the coarsest of three levels (convergence_of).
struct KnownError {
  std::optional<double> step, spacing;  ///< empty where a finer run ends otherwise or has no such number
  bool has_points = true;               ///< false: there is no spacing to be halved
  double tolerance = 0.0;               ///< of the metric itself, as that of a quantile of a histogram

  /// The whole error; empty if a part that can be known is not.
  std::optional<double> sum() const;
};

/// The runs of a comparison again, by step and by spacing.
class FinerRuns {
 public:
  /// Runs them, without files. `reports` are those of `comparison`; both have to outlive this. Throws Stopped.
  FinerRuns(const Comparison& comparison, std::span<const Result> reports, const JobOptions& jobs);

  /// Error of a metric of the run with that number in the comparison; metrics are taken at the times of its own rows.
  KnownError known_error(std::size_t run, const std::string& metric) const;

  /// Returns a clause that names the refinements of a scene, and the reason for each refinement that was left out.
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

}  // namespace hapbench
