#pragma once

#include <functional>
#include <map>
#include <optional>

#include "scenarios/batch/cases.hpp"

/// The search for the edge of the stable values of a field, whatever makes a value stable.
namespace hapbench {

/// Equal parts that a way is divided into before bisection.
inline constexpr int kEdgeIntervals = 16;

/// A range of values as a way from the end that is expected to be stable (part 0) to the other end (part 1).
struct SearchWay {
  Range range;                     ///< where the edge may lie, from < to; both ends are tried
  std::optional<double> own = {};  ///< the value from which the search goes on, if it lies in the range
  bool whole = false;              ///< values are integers
  bool smallest = false;           ///< the way begins at the high end
  /// Width at which bisection stops: relative to the value in a logarithmic range, to the range in a linear one.
  double resolution = 1e-3;

  double value_at(double part) const;
  /// The part of the own value.
  std::optional<double> own_part() const;
  /// True while bisection to this resolution has to go on between two parts.
  bool apart(double a, double b, double resolution) const;
};

/// The result of a search, as parts of the way.
struct FoundEdge {
  std::optional<double> stable;  ///< the last stable part
  std::optional<double> beyond;  ///< the first unstable part beyond it
  std::optional<double> first;   ///< the first stable part of the interval that ends with `stable`
  std::optional<double> before;  ///< the last unstable part before it
};

/// Which ends of so many equal parts of a way are stable, from its begin on.
std::map<double, bool> scanned(int intervals, const std::function<bool(double)>& stable);

/// The edge behind the own value, or if that is not stable behind the first stable values of the way; of the parts
/// `tried`, which hold at least both ends. With `beside`, tries values on either side of it, too, and goes on where one
/// of them shows an edge before it; then finds the other end of the interval.
FoundEdge find_edge(const SearchWay& way, std::map<double, bool> tried, const std::function<bool(double)>& stable,
                    double resolution, bool beside);

}  // namespace hapbench
