#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/studies/convergence/convergence.hpp"

/// What is known of the error of a run's numbers: how far runs with half and a quarter of the step, and of the distance
/// of the shell's points, move them.
namespace hapbench {

/// Of a number, in its unit. By step and by spacing it is the error that convergence_of gives the coarsest of three
/// levels: 1.25 |f - f*| with Richardson's value f* where an order is seen, else the largest plain difference.
struct KnownError {
  std::optional<double> step, spacing;  ///< none where a finer run ends otherwise or has no such number
  bool has_points = true;               ///< false: there is no spacing to be halved
  double tolerance = 0.0;               ///< of the metric itself, as that of a quantile of a histogram

  /// All of it together; none where a part that there is to know is not known.
  std::optional<double> sum() const;
};

/// The runs of a comparison again, by step and by spacing.
class FinerRuns {
 public:
  /// Runs them, without files. `reports` are those of `comparison`; both have to outlive this. Throws Stopped.
  FinerRuns(const Comparison& comparison, std::span<const Result> reports, const JobOptions& jobs);

  /// Of a metric of the run with that number in the comparison; metrics are taken at the times of its own rows.
  KnownError known_error(std::size_t run, const std::string& metric) const;

  /// What was refined of a scene, and why something was not, in a clause.
  std::string refined(std::size_t scene) const;

 private:
  struct Part {
    LevelSweep levels;
    std::size_t first = 0;  ///< number of the first finer run
    std::string why_not;    ///< why there are no levels; empty otherwise
  };
  struct Parts {
    Part step, spacing;
    bool has_points = true;
  };
  std::optional<double> error_by(const Part& part, std::size_t run, const std::string& metric) const;

  const Comparison& comparison_;
  std::span<const Result> reports_;
  std::vector<Parts> parts_;   ///< of each scene
  std::vector<Result> finer_;  ///< by part, then by level, then as in the comparison
};

/// A number of a table and what is known of its error.
struct NumberWithError {
  std::optional<double> value, error;
};

/// Places of numbers in the order that their errors leave.
struct HeldOrder {
  /// Each number of a group is less than every number of the groups behind it, and of none of its own, by more than
  /// both errors and by more than rounding.
  std::vector<std::vector<std::size_t>> groups;
  /// Numbers that would join groups which hold without them: their errors are too large for a place.
  std::vector<std::size_t> unplaced;
};

/// Numbers without a value or an error have no place. `rounding` is relative to the larger number.
HeldOrder held_order(std::span<const NumberWithError> numbers, double rounding);

/// The same in a sentence about named numbers: "the order holds: mean < proxy".
std::string held_text(std::span<const NumberWithError> numbers, std::span<const std::string> names, double rounding);

}  // namespace hapbench
