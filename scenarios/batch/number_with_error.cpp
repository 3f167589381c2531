#include "scenarios/batch/number_with_error.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

bool is_only_bounded(const NumberWithError& number) {
  return number.value && std::isfinite(*number.value) && number.error && *number.error > 0.0 &&
         *number.error >= std::abs(*number.value);
}

bool is_less(const NumberWithError& a, const NumberWithError& b) {
  const double difference = *b.value - *a.value;
  return difference > *a.error + *b.error &&
         difference > kRankResolution * std::max(std::abs(*a.value), std::abs(*b.value));
}

}  // namespace hapbench
