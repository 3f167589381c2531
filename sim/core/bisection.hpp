#pragma once

#include <cmath>
#include <limits>

namespace hapbench {

/// Values beyond this are taken for "never unstable".
inline constexpr double kLargestProbe = 1e15;

/// Moves `low` and `high` together, `low` where `stable` holds of the middle and `high` where it does not, while
/// `apart(low, high)`; `middle(low, high)` lies between them. Precondition: it holds at `low` and not at `high`.
template <class Stable, class Middle, class Apart>
void bisect(double& low, double& high, Stable stable, Middle middle, Apart apart) {
  while (apart(low, high)) {
    const double value = middle(low, high);
    (stable(value) ? low : high) = value;
  }
}

/// The largest value below which `stable` holds, by powers of `factor` from `start` and bisection of the logarithm down
/// to the relative width `precision`. Where the stable values are not one interval (velocity Verlet with damping is
/// stable again beyond its first edge) it is the first edge, unless that is the beginning of a gap narrower than a
/// `factor`. Zero when nothing is stable, infinite when everything up to `largest` is. About log2(1 / precision) calls
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
