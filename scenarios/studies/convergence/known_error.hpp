#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/batch/run_batch.hpp"
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

/// The runs of a batch again, by step and by spacing.
class FinerRuns {
 public:
  /// Runs them, without files. `report` is that of `plan`; both have to outlive this. Throws Stopped.
  FinerRuns(const BatchPlan& plan, const BatchReport& report, BatchOptions options);

  /// Of a metric of the run with that number in the plan; metrics are taken at the times of its own rows.
  KnownError known_error(std::size_t run, const std::string& metric) const;

  /// What was refined of a scenario, and why something was not, in a clause.
  std::string refined(std::size_t scenario) const;

 private:
  struct Part {
    LevelSweep levels;
    std::size_t half = 0;  ///< place of the first finer scenario among all
    std::string why_not;   ///< why there are no levels; empty otherwise
  };
  struct Parts {
    Part step, spacing;
    bool has_points = true;
  };
  void add(Part& part, const BatchPlan& plan, std::size_t scenario);
  std::optional<double> error_by(const Part& part, std::size_t run, const std::string& metric) const;

  const BatchPlan& plan_;
  const BatchReport& report_;
  std::vector<Parts> parts_;  ///< of each scenario
  BatchPlan finer_plan_;
  BatchReport finer_;
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
