#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Convergence of a metric in a field such as the time step: observed order, Richardson extrapolation and grid
/// convergence index (GCI; Roache 1994, ASME V&V 20) over refinement levels, or the reason why no order can be stated.
namespace hapbench {

/// A metric of the run at one level.
struct LevelResult {
  std::string setting;           ///< the field and its value, as text
  std::string outcome;           ///< name of the run's outcome
  std::optional<double> result;  ///< value of the metric; empty if the run diverged or lacks the metric
  /// Contact counts by name. If they differ between two levels of refinement, contacts have begun or ended at other
  /// times, so that the results of the levels may differ by a jump.
  std::vector<std::pair<std::string, double>> contacts = {};
  std::uint64_t state_hash = 0;  ///< equal for bitwise equal runs
  double spread = 0.0;           ///< Metric::sampling_spread of the metric
};

/// The properties of a metric that decide how it can be extrapolated, as in Metric.
struct MetricTraits {
  bool smooth = true, either_sign = true;
};

/// Convergence of one metric. r: ratio of the levels; p: observed order; f*: Richardson's value.
struct Convergence {
  /// p, computed from the three finest levels; empty if no order is stated (see convergence_of).
  std::optional<double> order;
  std::string reason;                  ///< why there is no order, as a clause; empty with an order
  std::optional<double> extrapolated;  ///< f*; only with an order
  std::optional<double> gci;  ///< GCI of the finest level, relative to its result; only with an order and a result != 0
  /// True if the levels are in the asymptotic range: |GCI_21 / (r^p GCI_32) - 1| <= 0.1 for the three finest levels (1:
  /// coarsest, 3: finest of the three), and, if a fourth level counts, also for the second to fourth finest levels with
  /// the same p.
  bool asymptotic = false;
  /// Smallest and largest result of the finest levels that count: of three levels, or of two if only two count; empty
  /// if fewer count. For a metric that is not smooth, the two numbers are moved apart, each by the sampling spread at
  /// the finest level.
  std::optional<std::pair<double, double>> band;
  /// Observed order at each level, computed from this level and the two next coarser levels; empty if undefined.
  std::vector<std::optional<double>> orders;
  /// Error estimate (not a bound) of each level [metric's unit]. With an order: 1.25 |f - f*|, which at the finest
  /// level equals |f| times the GCI. Without an order: the largest difference from the result of a finer level, but at
  /// least the range of the results of the last three levels. For a metric that is not smooth, the estimate is larger.
  /// With an order, the estimate is at least the range of the last three levels. Without an order, the difference of
  /// the two finest levels is added, divided by r - 1 if r < 2: at first order, all further levels together would
  /// change the result by the difference divided by r - 1. In both cases, the sampling spread at the finest level is
  /// added.
  std::vector<std::optional<double>> errors;
};

/// Returns the properties of a metric. If the list does not have the metric, returns the strictest properties: not
/// smooth, and never negative.
MetricTraits traits_of(const MetricList& list, const std::string& metric);

/// Returns a metric of the run at a level. `summary`: the result of this run.
LevelResult level_result(const LevelSweep& levels, std::size_t level, const Result& summary, const std::string& metric);

/// Returns the convergence of a metric from its results at all levels. Only the finest consecutive levels that have a
/// result and the same outcome as the finest level count. No order is stated if:
/// - all runs are bitwise equal;
/// - LevelSweep::no_order gives a reason;
/// - fewer than three levels count, or fewer than five for a metric that is not smooth;
/// - the last two results differ by rounding only;
/// - contacts switch between the last three levels (last five levels for a metric that is not smooth);
/// - within the last four levels (last five for a metric that is not smooth), differences change their sign
///   or an order is not in (0, 2 formal_order + log_r 1.1], with the ratio r of the levels;
/// - the extrapolated value is negative, although the metric cannot be negative.
Convergence convergence_of(const LevelSweep& sweep, std::span<const LevelResult> levels,
                           const MetricTraits& traits = {});

}  // namespace hapbench
