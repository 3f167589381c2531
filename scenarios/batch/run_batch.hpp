#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>
#include "scenarios/batch/finer_scene.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {

/// A batch runs every scenario with every algorithm and every seed.
struct BatchDefinition {
  std::vector<std::filesystem::path> scenarios;  ///< files
  std::vector<std::string> algorithms;
  std::vector<std::string> overrides;  ///< of all runs, as in --set
  std::size_t seeds = 1;               ///< repetition k has the scenario's seed + k
  double jitter = 0.0;                 ///< length of a random shift of the start [m]
  Skips skips = Skips::on;
};

/// One run of a batch, by indices into its definition.
struct BatchRun {
  std::size_t scenario = 0;
  std::size_t algorithm = 0;
  std::size_t seed = 0;
};

/// A batch that was checked before its first run. Runs are numbered by scenario first, then by algorithm, then by seed.
struct BatchPlan {
  BatchDefinition definition;
  std::vector<ScenarioText> scenarios;
  std::vector<std::string> names;     ///< unique names of the scenarios' files, without extension
  std::vector<std::string> warnings;  ///< without duplicates
  /// How each scenario is sampled more finely, after the overrides of the definition; may be empty as a whole.
  std::vector<FinerScene> finer = {};

  std::size_t size() const { return scenarios.size() * definition.algorithms.size() * definition.seeds; }
  BatchRun run(std::size_t number) const;
};

/// Loads every scenario with every algorithm and reads the files they name. Throws InputError for the first that is
/// wrong, for two scenarios of one name, and where jitter cannot shift the start because the motion prescribes it.
BatchPlan plan_batch(BatchDefinition definition);

/// A shift of the start [m] whose direction depends only on the scenario's seed, so that all algorithms start from the
/// same places. Directions are uniform on the sphere, in planar scenes on the circle z = 0.
Vec3 start_shift(const Scenario& scenario, double length);

/// The scenario of one run. Thread-safe. The start is shifted by the definition's jitter (start_shift).
LoadedScenario scenario_of(const BatchPlan& plan, std::size_t number);

/// Directory of a run's files, relative to that of the batch: [SCENARIO/]ALGORITHM[/seed_K], where the scenario is
/// omitted if there is only one, and so is the seed.
std::filesystem::path run_directory(const BatchPlan& plan, std::size_t number);

/// Directory of the tables of one scenario: SCENARIO if there are several, otherwise that of the batch itself.
std::filesystem::path scenario_directory(const BatchPlan& plan, std::size_t scenario);

struct BatchOptions {
  std::optional<std::filesystem::path> directory;  ///< for all files, must exist; none: nothing is written
  std::size_t jobs = 1;                            ///< runs at once
  bool progress = false;                           ///< allow a progress bar
};

struct BatchReport {
  std::vector<RunReport> runs;  ///< by number
};

/// Executes the runs of a plan, `jobs` at once, and writes the files of each into its directory. Runs in one
/// environment share its shell. Files do not depend on `jobs`. A run that fails does not stop the others; SIGINT and
/// SIGTERM end the batch after the runs in flight. Throws IoError when something cannot be written.
BatchReport run_batch(const BatchPlan& plan, const BatchOptions& options);

}  // namespace hapbench
