#include "results/observe/magnitude_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace hapbench {

MagnitudeHistogram& MagnitudeHistogram::operator+=(const MagnitudeHistogram& other) noexcept {
  std::transform(counts_.begin(), counts_.end(), other.counts_.begin(), counts_.begin(), std::plus<>());
  return *this;
}

double MagnitudeHistogram::quantile(double p) const noexcept {
  const std::uint64_t all = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
  const auto rank = static_cast<std::uint64_t>(std::ceil(p * static_cast<double>(all)));
  std::size_t bin = 0;
  for (std::uint64_t counted = counts_[0]; counted < rank; counted += counts_[bin]) ++bin;
  if (bin == 0) return 0.0;
  if (bin == kBins - 1) return std::numeric_limits<double>::infinity();
  const auto edge = [](std::uint64_t bits) { return std::sqrt(std::bit_cast<double>(bits << kDroppedBits)); };
  return 0.5 * (edge(kFirst + bin - 1) + edge(kFirst + bin));
}

}  // namespace hapbench
