#pragma once

#include <cmath>
#include <limits>

namespace hapbench {

/// A system that is stable up to this value is taken to be stable at every value.
inline constexpr double kLargestProbe = 1e15;

/// Bisects while `apart(low, high)`: `middle(low, high)` replaces `low` if `stable` holds there, else `high`.
/// Precondition: `stable` holds at `low` and not at `high`.
template <class Stable, class Middle, class Apart>
void bisect(double& low, double& high, Stable stable, Middle middle, Apart apart) {
  while (apart(low, high)) {
    const double value = middle(low, high);
    (stable(value) ? low : high) = value;
  }
}

/// Returns the largest value below which `stable` holds, found by powers of `factor` from `start` and bisection of the
/// logarithm down to the relative width `precision`. If the stable values are not one interval (velocity Verlet with
/// damping is stable again beyond its first edge), it is the first edge, unless a gap narrower than `factor` begins
/// there. Zero if nothing is stable, infinite if everything up to `largest` is. Takes about log2(1 / precision) calls
/// besides one for each power.
template <class Stable>
double largest_stable(double start, double precision, Stable stable, double largest = kLargestProbe,
                      double factor = 2.0) {
  double low = start;
  while (!stable(low)) {
    low /= 2.0;
    if (low < 1.0 / kLargestProbe) return 0.0;
  }
  double high = low;
  while (stable(high)) {
    low = high;
    high *= factor;
    if (high > largest) return std::numeric_limits<double>::infinity();
  }
  bisect(
      low, high, stable, [](double a, double b) { return std::sqrt(a * b); },
      [precision](double a, double b) { return b / a > 1.0 + precision; });
  return low;
}

}  // namespace hapbench
