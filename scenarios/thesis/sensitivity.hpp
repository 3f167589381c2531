#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// Sensitivity of a binary output (0 or 1) to the inputs of a sample: which input decides the output.
namespace hapbench {

/// Sorts the values and divides them into `bins` bins of equal count. Returns the bin of each value. Equal values keep
/// their order.
std::vector<std::size_t> equal_count_bins(std::span<const double> values, std::size_t bins);

/// Returns an estimate of the first-order Sobol index of an input x, Var(E[y | x]) / Var(y), from given data. x is
/// divided into bins (one for each value of a discrete input), and the mean of y in a bin estimates E[y | x]:
///
///   S = (SSB - (B - 1) SSW / (n - B)) / SST,  SSB = sum_b n_b (mean_b - mean)^2,  SSW = SST - SSB,
///
/// with n points, B nonempty bins, n_b points and the mean mean_b of y in bin b, the mean of all y, and the total sum
/// of squares SST = sum (y - mean)^2. The term (B - 1) SSW / (n - B) is the expected SSB if x has no influence. Without
/// this term, S is the estimator of Plischke, Borgonovo, Smith, "Global sensitivity measures from given data", EJOR 226
/// (2013) 536-550; with it, S is Kelley's epsilon squared (1935). S can be slightly negative. NaN if y is constant or n
/// <= B. `bin`: bin of each point. Precondition: `bin` and `y` have equal sizes.
double first_order_index(std::span<const std::size_t> bin, std::span<const double> y);

/// The input that decides the output.
struct DecidingInput {
  std::size_t input = 0;  ///< number of the input
  double index = 0.0;     ///< its first_order_index()
};

/// Returns the input with the largest first-order index if this index is significant at `level` by a permutation test:
/// the p-value is the fraction of random permutations of y whose largest index over all inputs is at least as large.
/// Using the largest index over all inputs corrects for the number of inputs. Empty if y is constant or the index is
/// not significant. `bins_of_inputs`: for each input, the bin of each point.
std::optional<DecidingInput> deciding_input(const std::vector<std::vector<std::size_t>>& bins_of_inputs,
                                            std::vector<double> y, std::uint64_t seed, double level = 0.01,
                                            std::size_t permutations = 999);

}  // namespace hapbench
