#include "scenarios/batch/number_with_error.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

bool is_less(const NumberWithError& a, const NumberWithError& b) {
  const double difference = *b.value - *a.value;
  return difference > *a.error + *b.error &&
         difference > kRankResolution * std::max(std::abs(*a.value), std::abs(*b.value));
}

}  // namespace hapbench
