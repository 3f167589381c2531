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

/// Inputs of the measurement of a claim: the published numbers, and access to results and bundled scenarios.
struct Evidence {
  PublishedNumbers published;
  std::filesystem::path directory;  ///< has a subdirectory with the results of each scenario, named like the scenario
  /// Called with a scenario's name before its results are read. Runs the scenario if necessary.
  std::function<void(const std::string& scenario)> provide;
  /// Returns the overrides with which load_scenario loads a bundled scenario. If the function is empty, there are no
  /// overrides.
  std::function<std::vector<std::string>(const Scenario&)> overrides = {};
  /// Called by scene() with the name of the bundled scenario. Not called for scenarios whose result files are read;
  /// `provide` is called for these scenarios. May be an empty function.
  std::function<void(const std::string& scenario)> used = {};

  // All functions below throw InputError if a scenario cannot be loaded or run, or if a result file is missing or has
  // another format.

  /// Returns a number of a scenario's summary.json at a dotted path, such as "metrics.force_max_N"; NaN if it is
  /// missing or null.
  double number(const std::string& scenario, const std::string& path) const;
  /// Returns the columns of a CSV result file of a scenario, by name. A cell without a number is NaN.
  std::map<std::string, std::vector<double>> table(const std::string& scenario, const std::string& file) const;
  /// Returns a single case: a bundled scenario with `overrides` applied, followed by the overrides `more`.
  Cases scene(const std::string& name, const std::vector<std::string>& more = {}) const;
  /// Loads the case of scene().
  LoadedScenario load(const std::string& name, const std::vector<std::string>& more = {}) const;
  /// Runs the case of scene() in memory, without result files.
  Result run(const std::string& name, const std::vector<std::string>& more = {}) const;
};

}  // namespace hapbench
