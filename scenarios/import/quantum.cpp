#include "scenarios/import/quantum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hapbench {

std::optional<double> quantum_of(std::span<const double> values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  if (sorted.empty()) return std::nullopt;
  // Differences of rounded numbers are multiples up to the rounding of the numbers themselves.
  const double largest = std::max(std::abs(sorted.front()), std::abs(sorted.back()));
  const double rounding = std::max(1e-10, 16.0 * std::numeric_limits<double>::epsilon() * largest);
  double quantum = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    // Euclid's algorithm for the greatest common divisor; a remainder is zero, or nearly the whole divisor, by
    // rounding.
    double rest = sorted[i] - sorted[i - 1];
    if (rest <= rounding) continue;
    while (rest > rounding) {
      const double remainder = std::abs(std::remainder(quantum, rest));
      quantum = rest;
      rest = remainder;
    }
    if (quantum <= 2.0 * rounding) return std::nullopt;
  }
  return quantum > 0.0 ? std::optional(quantum) : std::nullopt;
}

}  // namespace hapbench
