#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "scenarios/format/load_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// One number of results/reference/published.json. Parts that are not published have these values.
struct PublishedNumber {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double spread = 0.0;  ///< standard deviation or standard error, whichever is published
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};

/// The published numbers by id.
class PublishedNumbers {
 public:
  /// None.
  PublishedNumbers() = default;
  /// Reads the file. Throws InputError.
  explicit PublishedNumbers(const std::filesystem::path& file);
  /// Throws InputError for an id that is not there.
  const PublishedNumber& operator[](const std::string& id) const;
  /// The text with the numbers that it names by id: <T2.raw> becomes "37.8 ± 17.7", <T3.reduced.bound.at_most> "15".
  /// A part (mean, spread, at_least or at_most) may have a factor and a format, as <J1.depth.mean*1000:.2f>; without a
  /// format it is written as `plain` writes it (claims.hpp); no number is "none". Throws InputError for an id that is
  /// not there.
  std::string fill(const std::string& text) const;
  /// Adds a number of ours that rules read as they read published ones: a threshold (choices.hpp).
  void set(const std::string& id, double value) { numbers_[id].mean = value; }

 private:
  std::map<std::string, PublishedNumber> numbers_;
};

/// The sources of the measurements by which claims are judged.
struct Evidence {
  PublishedNumbers published;
  std::filesystem::path directory;  ///< of results, those of a scenario in a subdirectory of its name
  /// Called with the scenario's name before results are read: runs it, if scenarios are run on demand.
  std::function<void(const std::string& scenario)> provide;
  /// Returns the overrides of a bundled scenario, as for load_scenario; empty for none.
  std::function<std::vector<std::string>(const Scenario&)> overrides = {};
  /// Called with the name of every bundled scenario that a claim loads by itself; may be empty.
  std::function<void(const std::string& scenario)> used = {};

  // Results of a scenario. Both throw InputError when the file is missing or none of ours.

  /// A number of summary.json, as in "metrics.force_max_N"; NaN for null.
  double number(const std::string& scenario, const std::string& path) const;
  /// Columns of a CSV file, by name; a cell without a number is NaN.
  std::map<std::string, std::vector<double>> table(const std::string& scenario, const std::string& file) const;

  // Claims that compute something by themselves start from these functions. Both throw InputError.

  /// A bundled scenario with `overrides`, and then with `more` overrides.
  LoadedScenario load(const std::string& name, const std::vector<std::string>& more = {}) const;
  /// Runs it in memory.
  Result run(const std::string& name, const std::vector<std::string>& more = {}) const;
};

/// Runs a scenario in memory and calls `row` for each row, which has the contacts as they were found. Throws
/// InputError.
void for_each_row(const LoadedScenario& loaded, const std::function<void(const StepRecord&)>& row);

}  // namespace hapbench
