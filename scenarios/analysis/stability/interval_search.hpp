#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "scenarios/batch/axis.hpp"

/// Searches the interval of stable values in a range, whatever makes a value stable.
///
/// A search works on the parameter t in [0, 1] of the range: t = 0 is the end that is expected to be stable, t = 1 the
/// other end. Its answer is the interval of stable parameters around the current value, found by a scan and bisection.
namespace hapbench {

inline constexpr int kEdgeIntervals = 16;        ///< equal intervals of a scan before bisection
inline constexpr double kEdgeResolution = 1e-3;  ///< default relative width at which bisection on runs stops

/// A range of values, and how it is searched.
struct SearchWay {
  Range range;                     ///< where the limit may lie, from < to; both ends are evaluated
  std::optional<double> own = {};  ///< the current value, at which the search starts if it lies in the range
  bool whole = false;              ///< values are integers
  bool smallest = false;           ///< the search starts at the high end and finds the smallest stable value
  /// Width at which bisection stops: relative to the value in a logarithmic range, to the range in a linear one.
  double resolution = kEdgeResolution;

  /// Returns the value at a parameter.
  double value_at(double t) const;
  /// Returns the parameter of the current value; empty if there is none.
  std::optional<double> own_part() const;
  /// Returns true while bisection has to go on between two parameters.
  bool apart(double a, double b) const;
};

/// The result of a search, in parameters: the interval of stable parameters from `first` to `stable`, and the unstable
/// parameters next to it, `before` and `beyond`.
struct FoundEdge {
  std::optional<double> stable = {}, beyond = {};
  std::optional<double> first = {}, before = {};
  bool scattered = false;  ///< there are stable parameters, but no contiguous stable interval as long as kNear
};

/// The parameters that were evaluated, and whether they are stable.
using TriedParts = std::map<double, bool>;
/// Evaluates a parameter: returns true if it is stable.
using IsStable = std::function<bool(double t)>;

/// Evaluates the ends of `intervals` equal intervals of the range, from t = 0 on.
TriedParts scanned(int intervals, const IsStable& stable);

/// Bisects the first stable-to-unstable transition above the current value, or above the first stable parameter if the
/// current value is unstable. `tried` has the parameters evaluated before, at least both ends; those of the search are
/// added. With `beside`, evaluates three more parameters on either side of the transition. If they show an earlier
/// transition, bisects that one instead, up to five times, and at the end bisects the other end of the interval.
FoundEdge find_edge(const SearchWay& way, TriedParts& tried, const IsStable& stable, bool beside);

// Bisection can miss unstable values inside an interval: loops in contact have islands of unstable values that are 1 %
// of a range wide. An interval is therefore verified by further samples.
inline constexpr std::size_t kTriedBetween = 48;  ///< verification samples between the ends of the interval
inline constexpr std::size_t kTriedNear = 8;      ///< further samples just below the limit
inline constexpr double kNear = 0.02;             ///< largest relative distance of these from the limit

/// Returns the largest fraction of an interval that is unstable at 95 % confidence if `tried` samples are all stable.
double may_fail_share(std::size_t tried);

/// Returns `count` parameters between two others: the first n of them fill the interval evenly for every n.
std::vector<double> parts_between(double from, double to, std::size_t count);

/// Returns kTriedNear parameters below `t` whose values are within kNear of its value.
std::vector<double> parts_below(const SearchWay& way, double t);

/// Finds a transition as find_edge does with `beside`, and verifies its interval: by samples between its ends and, with
/// `near`, just below the limit. The first sample that is not stable ends the interval, and the search continues from
/// there. Calls `ahead` with parameters before it evaluates them, so that they can be evaluated in parallel.
FoundEdge find_tried_edge(const SearchWay& way, TriedParts& tried, const IsStable& stable, bool near,
                          const std::function<void(std::span<const double>)>& ahead);

}  // namespace hapbench
