#pragma once

#include <optional>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

/// The recorded tables of a run, kept in memory.
struct RunTables {
  std::vector<RecordedTables> trials;
  std::optional<MemoryTable> targets;  ///< content of targets.csv; empty unless the hand is a tracking hand
  Json effective;  ///< content of scenario.effective.json, with paths relative to the working directory

  /// Finishes the recorders, and sets `effective` and `targets`. Throws std::bad_alloc if memory ran out and
  /// recorded rows were lost.
  void write(const Json& of_scenario, const Result& result, const Recorders& recorders);
};

}  // namespace hapbench
