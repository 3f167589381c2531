#include "scenarios/batch/number_with_error.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

bool is_less(const NumberWithError& a, const NumberWithError& b) {
  const double apart = *b.value - *a.value;
  return apart > *a.error + *b.error && apart > kSameRank * std::max(std::abs(*a.value), std::abs(*b.value));
}

}  // namespace hapbench
