#pragma once

#include <cmath>
#include <limits>

namespace hapbench {

/// Values beyond this are taken for "never unstable".
inline constexpr double kLargestProbe = 1e15;

/// The largest value below which `stable` holds, by powers of two from `start` and bisection of the logarithm down to
/// the relative width `precision`. Where the stable values are not one interval (velocity Verlet with damping is stable
/// again beyond its first edge) it is the first edge, unless that is the beginning of a gap narrower than a factor of
/// two. Zero when nothing is stable, infinite when everything up to `largest` is. About log2(1 / precision) calls
/// besides one for each power of two.
template <class Stable>
double largest_stable(double start, double precision, Stable stable, double largest = kLargestProbe) {
  double low = start;
  while (!stable(low)) {
    low /= 2.0;
    if (low < 1.0 / kLargestProbe) return 0.0;
  }
  double high = low;
  while (stable(high)) {
    low = high;
    high *= 2.0;
    if (high > largest) return std::numeric_limits<double>::infinity();
  }
  while (high / low > 1.0 + precision) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace hapbench
