#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/description/scenario_text.hpp"

namespace hapbench {

/// What a batch runs: every scenario with every algorithm and every seed.
struct BatchDefinition {
  std::vector<std::filesystem::path> scenarios;  ///< files
  std::vector<std::string> algorithms;
  std::vector<std::string> overrides;  ///< of all runs, as in --set
  std::size_t seeds = 1;               ///< repetition k has the scenario's seed + k
  double jitter = 0.0;                 ///< length of a random shift of the start [m]
  Skips skips = Skips::taken;
};

/// One run of a batch, by the places of its parts in the definition.
struct BatchRun {
  std::size_t scenario = 0;
  std::size_t algorithm = 0;
  std::size_t seed = 0;
};

/// A batch, checked before its first run. Runs are numbered scenario by scenario, in there algorithm by algorithm, in
/// there seed by seed.
struct BatchPlan {
  BatchDefinition definition;
  std::vector<ScenarioText> scenarios;
  std::vector<std::string> names;     ///< of the scenarios' files, without extension; each once
  std::vector<std::string> warnings;  ///< each once

  std::size_t size() const { return scenarios.size() * definition.algorithms.size() * definition.seeds; }
  BatchRun run(std::size_t number) const;
};

/// Loads every scenario with every algorithm and reads the files they name. Throws InputError for the first that is
/// wrong, for two scenarios of one name, and where jitter cannot shift the start because the motion prescribes it.
BatchPlan plan_batch(BatchDefinition definition);

/// The scenario of one run. For several threads. The start is shifted by a vector of the definition's length and of a
/// direction that depends on the run's seed alone, so that all algorithms start from the same places: uniform on the
/// sphere, in planar scenes on the circle z = 0.
LoadedScenario scenario_of(const BatchPlan& plan, std::size_t number);

/// Where a run's files go, from the directory of the batch: ALGORITHM, below SCENARIO when there are several and above
/// seed_K when there are several seeds.
std::filesystem::path run_directory(const BatchPlan& plan, std::size_t number);

/// Where the tables of one scenario go: SCENARIO when there are several, else the directory of the batch itself.
std::filesystem::path scenario_directory(const BatchPlan& plan, std::size_t scenario);

}  // namespace hapbench
