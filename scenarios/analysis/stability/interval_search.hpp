#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "scenarios/batch/axis.hpp"

/// Searches a range for the interval of stable values. The caller's predicate (IsStable) decides what stable means.
///
/// A search works on the parameter t in [0, 1] of the range: t = 0 is the end that is expected to be stable, t = 1 the
/// other end. The result is the interval of stable parameters around the current value, found by a scan and bisection.
namespace hapbench {

inline constexpr int kScanIntervals = 16;             ///< number of equal intervals of the scan before bisection
inline constexpr double kBisectionResolution = 1e-3;  ///< default relative width at which bisection stops

/// The range of a search and its settings.
struct IntervalSearchOptions {
  Range range;  ///< from < to; both ends are evaluated
  /// Scenario's value, where the search starts; empty if it is outside of the range.
  std::optional<double> current = {};
  bool whole = false;     ///< true: values are integers
  bool smallest = false;  ///< true: t = 0 is the high end, and the result is the smallest stable value
  /// Width of the interval at which bisection stops: a fraction of the value in a logarithmic range, a fraction of
  /// the range in a linear range.
  double resolution = kBisectionResolution;

  /// Returns the value at the parameter `t`, rounded if `whole`.
  double value_at(double t) const;
  /// Returns the parameter of the current value; empty if `current` is empty.
  std::optional<double> current_parameter() const;
  /// If `whole` is true, returns true if the values at two parameters differ by more than 1. Otherwise returns true if
  /// they differ by more than the resolution.
  bool needs_bisection(double a, double b) const;
};

/// The interval of stable parameters that a search found, from `first` to `stable`, and its unstable neighbours.
struct StableInterval {
  std::optional<double> stable = {};  ///< largest stable parameter of the interval; empty if no interval was found
  std::optional<double> beyond = {};  ///< unstable parameter just above `stable`; empty if t = 1 is stable
  /// Smallest stable parameter of the interval; empty if this end was not searched.
  std::optional<double> first = {};
  std::optional<double> before = {};  ///< unstable parameter just below `first`; empty if t = 0 is stable
  /// True if stable parameters exist, but no contiguous stable interval is as long as kNearLimit times the limit.
  bool scattered = false;
  /// True if the current value is stable, but its stable interval is shorter than kNearLimit times its limit. The
  /// result is then the first longer interval, counted from t = 0.
  bool scattered_at_current = false;
};

/// Evaluated parameters. The value of an entry is true if the parameter is stable.
using EvaluatedParameters = std::map<double, bool>;
/// Evaluates a parameter. Returns true if it is stable.
using IsStable = std::function<bool(double t)>;

/// Divides [0, 1] into `intervals` equal intervals and returns their end points, from t = 0 to t = 1.
std::vector<double> scan_parameters(int intervals);
/// Evaluates scan_parameters(), from t = 0 to t = 1.
EvaluatedParameters evaluate_scan(int intervals, const IsStable& stable);
/// Returns the values at scan_parameters().
std::vector<double> scan_values(const IntervalSearchOptions& options, int intervals);

/// Bisects the first stable-to-unstable transition above the current value, or above the first stable parameter if the
/// current value is unstable. Returns an empty interval if no parameter is stable. On input `evaluated` has at least
/// t = 1; the search adds all parameters that it evaluates.
///
/// If `beside` is false, finds only `stable` and `beyond`. If `beside` is true, also evaluates three parameters on each
/// side of the transition. If these parameters show an earlier transition, bisects the earlier transition instead, up
/// to five times. Finally bisects the other end of the interval.
StableInterval find_stable_interval(const IntervalSearchOptions& options, EvaluatedParameters& evaluated,
                                    const IsStable& stable, bool beside);

// Bisection can miss unstable values inside an interval: feedback loops in contact have islands of unstable values as
// narrow as 1 % of a range. Further samples therefore verify an interval.
inline constexpr std::size_t kVerificationSamples = 48;  ///< verification samples between the ends of the interval
inline constexpr std::size_t kSamplesNearLimit = 8;      ///< further samples just below the limit
/// Largest distance of the kSamplesNearLimit samples from the limit, relative to the limit.
inline constexpr double kNearLimit = 0.02;

/// Returns an upper bound, at 95 % confidence, of the fraction of unstable values in an interval in which all of
/// `samples` samples are stable: 1 - 0.05^(1 / samples).
double may_fail_share(std::size_t samples);

/// Returns `count` parameters between `from` and `to`: a golden-ratio sequence, whose first n parameters fill the
/// interval evenly for every n.
std::vector<double> parameters_between(double from, double to, std::size_t count);

/// Returns kSamplesNearLimit parameters below `t`. Their values differ from the value v at `t` by at most kNearLimit
/// |v|; in a linear range, by at most the larger of kNearLimit |v| and kNearLimit * resolution * (to - from).
std::vector<double> parameters_below(const IntervalSearchOptions& options, double t);

/// Finds an interval as find_stable_interval does with `beside`, and verifies it: by kVerificationSamples samples
/// between its ends and, if `near` is true, by kSamplesNearLimit samples just below the limit. If a sample is unstable,
/// searches again with this sample as an unstable parameter. Ignores intervals that are shorter than kNearLimit times
/// their limit, also the interval of the current value. Calls `ahead` with parameters before it evaluates them, so that
/// the caller can evaluate them in parallel.
StableInterval find_verified_interval(IntervalSearchOptions options, EvaluatedParameters& evaluated,
                                      const IsStable& stable, bool near,
                                      const std::function<void(std::span<const double>)>& ahead);

}  // namespace hapbench
