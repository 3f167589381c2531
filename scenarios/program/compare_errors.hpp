#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/input/json_file.hpp"

/// `compare --errors`: which numbers of a comparison are how sure, and which order of laws is larger than that.
namespace hapbench {

/// The errors of a comparison's numbers, in words and as JSON.
struct ComparedErrors {
  /// By how much a metric of the run with that number may be wrong; none where it is not known. Valid as long as what
  /// errors_of was given.
  std::function<std::optional<double>(std::size_t run, const std::string& metric)> of_run;
  std::string text;           ///< for each scenario a table and a sentence on each metric
  Json json = Json::array();  ///< an object for each scenario and metric
};

/// Runs the comparison more finely. `metrics` as in league_of. Throws Stopped.
ComparedErrors errors_of(const Comparison& comparison, std::span<const Result> reports,
                         const std::vector<std::string>& metrics, const JobOptions& jobs);

}  // namespace hapbench
