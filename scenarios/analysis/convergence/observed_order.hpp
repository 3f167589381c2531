#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/run/run_scenario.hpp"

/// How far a number is from converged in a scene's step or any other field: observed order, Richardson's value and grid
/// convergence index (Roache 1994; ASME V&V 20) at the levels of the field; or why no order can be stated.
namespace hapbench {

/// Result of the run at one level.
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

/// Returns the result of a metric at a level. The result is empty if the run has no such metric or diverges.
LevelResult level_result(const LevelSweep& levels, std::size_t level, const Result& summary, const std::string& metric);

/// Judges the results of all levels. Those count that follow the last one that ended otherwise than the finest or has
/// no result. No order is stated where all runs are the same; for the reason that the levels have (`no_order`); with
/// fewer than three that count; where contacts switch between the last three or the last two differ by rounding only;
/// where within the last four differences change their sign or an order is not in (0, 2 formal].
Convergence convergence_of(const LevelSweep& sweep, std::span<const LevelResult> levels);

}  // namespace hapbench
