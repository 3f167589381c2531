#include "scenarios/batch/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

namespace hapbench {

double mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::nan("");
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standard_deviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double standard_error(const std::vector<double>& values) {
  return values.empty() ? 0.0 : standard_deviation(values) / std::sqrt(static_cast<double>(values.size()));
}

double paired_t(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() < 2) return 0.0;
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i) differences.push_back(a[i] - b[i]);
  const double mean = mean_of(differences), error = standard_error(differences);
  if (error == 0.0) return mean == 0.0 ? 0.0 : std::copysign(std::numeric_limits<double>::infinity(), mean);
  return mean / error;
}

double critical_t(std::size_t degrees) {
  constexpr double kCritical[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  if (degrees == 0) return std::numeric_limits<double>::infinity();
  return kCritical[std::min(degrees, std::size(kCritical)) - 1];
}

}  // namespace hapbench
