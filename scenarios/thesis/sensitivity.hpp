#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// Sensitivity of a yes or no to the inputs of a sample: which input decides it.
namespace hapbench {

/// Returns for each value the number of its bin, when the values in order are cut into `bins` of equal count. Equal
/// values keep their order.
std::vector<std::size_t> equal_count_bins(std::span<const double> values, std::size_t bins);

/// The first-order Sobol index of an input, Var(E[y | x]) / Var(y), from given data: x is cut into bins (one for each
/// value of a discrete input) and E[y | x] is the mean of y in a bin,
///
///   S = (SSB - (B - 1) SSW / (n - B)) / SST,  SSB = sum_b n_b (mean_b - mean)^2,  SSW = SST - SSB,
///
/// for n points in B bins that are not empty. Without the subtracted term, the mean of SSB when x has no influence,
/// this is the estimator of Plischke, Borgonovo, Smith, "Global sensitivity measures from given data", EJOR 226 (2013)
/// 536-550; with it, Kelley's epsilon squared (1935). May be a little below 0. NaN when y never changes or there are no
/// more points than bins. Precondition: as many bins as values.
double first_order_index(std::span<const std::size_t> bin, std::span<const double> y);

struct DecidingInput {
  std::size_t input = 0;
  double index = 0.0;
};

/// The input with the largest first-order index, if less than `level` of `permutations` random orders of y (seeded)
/// have a largest index as large: the largest of all inputs, so that many inputs do not make a false alarm likely. None
/// when y never changes.
std::optional<DecidingInput> deciding_input(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                            std::vector<double> y, std::uint64_t seed, double level = 0.01,
                                            std::size_t permutations = 999);

}  // namespace hapbench
