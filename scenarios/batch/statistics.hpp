#pragma once

#include <cstddef>
#include <vector>

/// Means of repeated runs, their standard errors and Student's t test.
namespace hapbench {

/// NaN if empty.
double mean_of(const std::vector<double>& values);
/// Standard deviation of a sample, with n - 1 in the denominator; 0 for fewer than two values.
double standard_deviation(const std::vector<double>& values);
/// Standard error of the mean: standard deviation / sqrt(n); 0 for fewer than two values.
double standard_error(const std::vector<double>& values);
/// Student's t of a paired test; 0 for fewer than two pairs, infinite when all pairs have the same difference.
double paired_t(const std::vector<double>& a, const std::vector<double>& b);
/// Two-sided 5 % quantile of Student's t, to 5e-4; infinite for 0 degrees of freedom. Beyond 10 that of 10, which is a
/// little strict: an experiment of the thesis has six subjects.
double critical_t(std::size_t degrees);

}  // namespace hapbench
