#pragma once

#include <optional>

/// Numbers that are compared up to their errors.
namespace hapbench {

/// Numbers whose relative difference is below this count as equal: the resolution of a table of ratios with three
/// digits, far above rounding errors, by which equivalent algorithms differ.
inline constexpr double kSameRank = 1e-3;

/// A number of a table and what is known of its error.
struct NumberWithError {
  std::optional<double> value = {}, error = {};
};
/// True when the first number is less by more than both errors and by more than kSameRank of the larger one.
/// Precondition: both have a value and an error.
bool is_less(const NumberWithError& a, const NumberWithError& b);

}  // namespace hapbench
