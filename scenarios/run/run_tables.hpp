#pragma once

#include <optional>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

/// What a run would have written, in memory.
struct RunTables {
  std::vector<RecordedTables> trials;
  std::optional<MemoryTable> targets;  ///< targets.csv, of a tracking hand
  Json effective;                      ///< scenario.effective.json, with paths from the working directory

  /// Ends the recorders, and adds what is not of one trial. Throws std::bad_alloc when rows were lost.
  void write(const Json& of_scenario, const Result& result, const Recorders& recorders);
};

}  // namespace hapbench
