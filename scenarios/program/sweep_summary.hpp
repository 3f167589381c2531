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

/// What `sweep` prints: of one field the runs with their main metrics, if they are not too many, and the counts.
std::string summary_text(const SweepPlan& plan, const SweepReport& report, const SweepSummary& summary);
Json summary_json(const SweepPlan& plan, const SweepReport& report, const SweepSummary& summary);

}  // namespace hapbench
