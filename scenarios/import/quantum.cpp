#include "scenarios/import/quantum.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hapbench {

std::optional<double> quantum_of(std::span<const double> values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  if (sorted.empty()) return std::nullopt;
  // Differences are multiples up to the rounding of doubles, which Euclid's algorithm magnifies: below 1e-9 of the
  // largest value nothing can be told.
  const double largest = std::max(std::abs(sorted.front()), std::abs(sorted.back()));
  const double rounding = std::max(1e-10, 1e-9 * largest);
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
    // What is magnified is taken back: the whole span so far is a multiple too, and known best.
    const double span = sorted[i] - sorted.front();
    quantum = span / std::round(span / quantum);
  }
  return quantum > 0.0 ? std::optional(quantum) : std::nullopt;
}

}  // namespace hapbench
