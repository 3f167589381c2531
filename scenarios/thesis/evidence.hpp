#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// The results and scenarios that claims are measured with.
namespace hapbench {

/// The published numbers, and access to the results and scenarios that a claim is measured with.
struct Evidence {
  PublishedNumbers published;
  std::filesystem::path directory;  ///< of results, those of a scenario in a subdirectory of its name
  /// Called with a scenario's name before its results are read, to run it.
  std::function<void(const std::string& scenario)> provide;
  /// The overrides of a bundled scenario, as for load_scenario; empty for none.
  std::function<std::vector<std::string>(const Scenario&)> overrides = {};
  /// Called with the name of every bundled scenario that a claim loads by itself; may be empty.
  std::function<void(const std::string& scenario)> used = {};

  // All functions throw InputError, also when the file of a result is missing or none of ours.

  /// Returns a number of a scenario's summary.json, as in "metrics.force_max_N"; NaN for null.
  double number(const std::string& scenario, const std::string& path) const;
  /// Returns the columns of a CSV file among a scenario's results, by name; a cell without a number is NaN.
  std::map<std::string, std::vector<double>> table(const std::string& scenario, const std::string& file) const;
  /// Returns a bundled scenario with `overrides`, and then with `more` overrides: a single case.
  Cases scene(const std::string& name, const std::vector<std::string>& more = {}) const;
  /// Loads that case.
  LoadedScenario load(const std::string& name, const std::vector<std::string>& more = {}) const;
  /// Runs that case in memory.
  Result run(const std::string& name, const std::vector<std::string>& more = {}) const;
};

}  // namespace hapbench
