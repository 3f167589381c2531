#pragma once

#include <map>
#include <string>
#include <vector>

namespace hapbench {

/// What was measured in one case of a claim, such as a density or an algorithm: numbers by name, several under one name
/// where each subject has its own.
struct MeasuredCase {
  std::string name;  ///< empty where the claim has a single case
  std::map<std::string, std::vector<double>> values;

  /// The value of a name that has one. Throws std::out_of_range for other names.
  double operator[](const std::string& value) const { return all(value).at(0); }
  const std::vector<double>& all(const std::string& value) const { return values.at(value); }
};

/// All numbers that decide a claim beside the published ones, so that it can be judged again at any time.
using Measured = std::vector<MeasuredCase>;

}  // namespace hapbench
