#pragma once

#include <cstddef>
#include <vector>

/// Means of repeated runs, their standard errors and Student's t test.
namespace hapbench {

/// Returns the mean; NaN for an empty list.
double mean_of(const std::vector<double>& values);
/// Returns the standard deviation of a sample, with n - 1 in the denominator; 0 for fewer than two values.
double standard_deviation(const std::vector<double>& values);
/// Returns the standard error of the mean: standard deviation / sqrt(n); 0 for fewer than two values.
double standard_error(const std::vector<double>& values);
/// Returns Student's t of a paired test; 0 for fewer than two pairs. Infinite if all pairs have the same
/// non-zero difference.
double paired_t(const std::vector<double>& a, const std::vector<double>& b);
/// Returns the critical value of Student's t for a two-sided test at 5 %, accurate to 5e-4. Infinite for 0 degrees of
/// freedom. Above 10 degrees of freedom, returns the value for 10, which makes the test slightly conservative. An
/// experiment of the thesis has six subjects, that is, five degrees of freedom.
double critical_t(std::size_t degrees);

}  // namespace hapbench
