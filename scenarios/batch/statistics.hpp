#pragma once

#include <cstddef>
#include <vector>

namespace hapbench {

/// NaN of none.
double mean_of(const std::vector<double>& values);

/// Of a sample, with n - 1; 0 for fewer than two values.
double standard_deviation(const std::vector<double>& values);

/// Of the mean: standard deviation / sqrt(n); 0 for fewer than two values.
double standard_error(const std::vector<double>& values);

/// t of a paired test; 0 for fewer than two pairs, infinite when all pairs differ alike.
double paired_t(const std::vector<double>& a, const std::vector<double>& b);

/// The level of `critical_t`.
inline constexpr double kSignificance = 0.05;
/// Two-sided 5 % quantile of Student's t for 1 … 10 degrees of freedom; beyond, that of 10, which is a little strict.
/// Infinite for none.
double critical_t(std::size_t degrees);

}  // namespace hapbench
