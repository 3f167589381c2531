#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// One number of results/reference/published. Parts that are not published have these values.
struct PublishedNumber {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double spread = 0.0;  ///< standard deviation or standard error, whichever is published
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};

/// The published numbers by id.
class PublishedNumbers {
 public:
  /// Reads every .json file of the directory. Throws InputError for files that are not such.
  explicit PublishedNumbers(const std::filesystem::path& directory);
  /// Throws InputError for an id that is not there.
  const PublishedNumber& operator[](const std::string& id) const;
  /// The text with the numbers that it names by id: <T2.raw> becomes "37.8 ± 17.7", <T3.reduced.bound.at_most> "15".
  /// A part (mean, spread, at_least or at_most) may have a factor and a format, as <J1.depth.mean*1000:.2f>; without a
  /// format it is written as `plain` writes it (claims.hpp). Throws InputError for an id that is not there.
  std::string fill(const std::string& text) const;
  /// Adds a number of ours that rules read as they read published ones: a threshold (choices.hpp).
  void set(const std::string& id, double value) { numbers_[id].mean = value; }

 private:
  std::map<std::string, PublishedNumber> numbers_;
};

/// Result files of scenarios, each in a subdirectory of one directory.
class ResultFiles {
 public:
  /// Called before results are read, with a scenario's name and the part that is read: a file's name or, for a number,
  /// its section of summary.json, as "metrics". Runs the scenario if scenarios are run on demand.
  using Provide = std::function<void(const std::string& scenario, const std::string& part)>;
  ResultFiles(std::filesystem::path directory, Provide provide)
      : directory_(std::move(directory)), provide_(std::move(provide)) {}

  /// summary.json of a scenario. Throws InputError when it is missing.
  Json summary(const std::string& scenario) const;
  /// A number of it, as in "metrics.force_max_N"; NaN for null.
  double number(const std::string& scenario, const std::string& path) const;
  /// Columns of a CSV file of a scenario, by name; an empty cell is NaN. Throws InputError
  /// when it is missing, empty, or has a row with more or fewer cells than columns.
  std::map<std::string, std::vector<double>> table(const std::string& scenario, const std::string& file) const;

 private:
  Json read_summary(const std::string& scenario) const;

  std::filesystem::path directory_;
  Provide provide_;
};

/// The sources of the measurements by which claims are judged.
struct Evidence {
  PublishedNumbers published;
  ResultFiles results;
  /// Returns the overrides of a bundled scenario, as for load_scenario; empty for none.
  std::function<std::vector<std::string>(const Scenario&)> overrides = {};

  /// Called with the name of every bundled scenario that a claim loads by itself; may be empty.
  std::function<void(const std::string& scenario)> used = {};

  // Claims that compute something by themselves start from these functions. All throw InputError.

  /// A bundled scenario with `overrides`, and then with `more` overrides.
  LoadedScenario load(const std::string& name, std::span<const std::string> more = {}) const;
  /// Runs it in memory.
  Result run(const std::string& name, std::span<const std::string> more = {}) const;
  /// Its environment; null for springs.
  std::shared_ptr<const PointShell> shell(const LoadedScenario& loaded) const;
  /// Runs it in memory and calls `row` for each row.
  void for_each_row(const LoadedScenario& loaded, const std::function<void(const StepRecord&)>& row) const;
};

}  // namespace hapbench
