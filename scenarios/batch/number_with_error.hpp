#pragma once

#include <optional>

/// Compares numbers that have errors.
namespace hapbench {

/// Relative difference below which two numbers count as equal. It is the resolution of ratios that a table shows with
/// three digits, and far above the rounding errors by which mathematically equivalent algorithms differ.
inline constexpr double kRankResolution = 1e-3;

/// A number of a table and its error, in the same unit. A member is empty if it is not known.
struct NumberWithError {
  std::optional<double> value = {}, error = {};
};
/// Returns true if the error is above 0 and at least as large as the magnitude of the number, so that only a bound of
/// the number is known.
bool is_only_bounded(const NumberWithError& number);
/// Returns true if `a` is smaller than `b` by more than the sum of both errors, and by more than kRankResolution
/// times the larger magnitude. Precondition: both have a value and an error.
bool is_less(const NumberWithError& a, const NumberWithError& b);

}  // namespace hapbench
