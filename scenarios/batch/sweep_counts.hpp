#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "scenarios/batch/sweep_plan.hpp"

namespace hapbench {

/// How the runs of a sweep ended.
struct SweepCounts {
  struct Count {
    std::size_t runs = 0;
    std::size_t expected = 0;
  };
  std::map<std::string, Count> outcomes;
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t unexpected = 0;  ///< runs that ended otherwise than their scenario expects, failed ones not included
  std::optional<std::size_t> first_unexpected;

  /// Adds a run by its row (sweep_row.hpp).
  void add(const SweepPlan& plan, std::size_t run, std::string_view row);
};

}  // namespace hapbench
