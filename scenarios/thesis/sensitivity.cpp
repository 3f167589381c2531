#include "scenarios/thesis/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/core/random.hpp"

namespace hapbench {
namespace {

/// Returns the input with the largest first-order index; empty if all indices are NaN.
std::optional<DecidingInput> largest_index(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                           std::span<const double> y) {
  std::optional<DecidingInput> largest;
  for (std::size_t i = 0; i < bins_of_inputs.size(); ++i) {
    const double index = first_order_index(bins_of_inputs[i], y);
    if (!std::isnan(index) && (!largest || index > largest->index)) largest = DecidingInput{i, index};
  }
  return largest;
}

}  // namespace

std::vector<std::size_t> equal_count_bins(std::span<const double> values, std::size_t bins) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [values](std::size_t i) { return values[i]; });
  std::vector<std::size_t> bin(values.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) bin[order[rank]] = rank * bins / order.size();
  return bin;
}

double first_order_index(std::span<const std::size_t> bin, std::span<const double> y) {
  if (y.empty()) return std::nan("");
  const auto n = static_cast<double>(y.size());
  const double mean = std::accumulate(y.begin(), y.end(), 0.0) / n;
  std::vector<double> sums(*std::max_element(bin.begin(), bin.end()) + 1), counts(sums.size());
  // Sum deviations from the mean: total sum of squares (SST), and sums by bin.
  double total = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    total += (y[i] - mean) * (y[i] - mean);
    sums[bin[i]] += y[i] - mean;
    counts[bin[i]] += 1.0;
  }
  // Sum of squares between the bins (SSB), and the number of nonempty bins (B).
  double between = 0.0, filled = 0.0;
  for (std::size_t b = 0; b < sums.size(); ++b) {
    if (counts[b] == 0.0) continue;
    between += sums[b] * sums[b] / counts[b];
    filled += 1.0;
  }
  if (total == 0.0 || n <= filled) return std::nan("");
  return (between - (filled - 1.0) * (total - between) / (n - filled)) / total;
}

std::optional<DecidingInput> deciding_input(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                            std::vector<double> y, std::uint64_t seed, double level,
                                            std::size_t permutations) {
  const std::optional<DecidingInput> found = largest_index(bins_of_inputs, y);
  if (!found) return std::nullopt;
  Random random(seed);
  std::size_t as_large = 0;
  for (std::size_t i = 0; i < permutations; ++i) {
    random.shuffle(y);
    as_large += largest_index(bins_of_inputs, y)->index >= found->index ? 1U : 0U;
  }
  // The observed order counts as one of the permutations (Phipson and Smyth 2010).
  const double p = static_cast<double>(as_large + 1) / static_cast<double>(permutations + 1);
  return p <= level ? found : std::nullopt;
}

}  // namespace hapbench
