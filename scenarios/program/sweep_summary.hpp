#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/run_sweep.hpp"

namespace hapbench {

/// A sweep's rows, counted.
struct SweepSummary {
  struct Count {
    std::size_t runs = 0;
    std::size_t expected = 0;
  };
  std::map<std::string, Count> outcomes;
  std::size_t failed = 0;
  std::size_t unexpected = 0;  ///< runs that ended otherwise than their scenario expects, failed ones not included
  std::optional<std::size_t> first_unexpected;
};

SweepSummary summarise(const SweepPlan& plan, const std::vector<std::string>& rows);

/// The metric `sweep` shows: the one asked for, or else the first of kDefaultMetrics that the runs have. Throws
/// InputError when they have none of that name.
std::string chosen_metric(const SweepPlan& plan, const std::string& asked_for);

/// What `sweep` prints: of one field the runs with their main metrics, if they are not too many, of two the grid of the
/// metric (grid_text), and the counts.
std::string summary_text(const SweepPlan& plan, const SweepReport& report, const SweepSummary& summary,
                         const std::string& metric);
/// With the rows, of 10 000 runs at most.
Json summary_json(const SweepPlan& plan, const SweepReport& report, const SweepSummary& summary);

}  // namespace hapbench
