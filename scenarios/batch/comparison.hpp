#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/batch/cases.hpp"

/// Comparisons: scenes, each under the same laws and with the same number of seeds.
namespace hapbench {

/// The question of `compare`.
struct ComparisonQuestion {
  std::vector<std::filesystem::path> scenarios;  ///< files
  std::vector<std::string> algorithms;
  std::vector<std::string> overrides = {};  ///< of all runs, as in --set
  std::uint64_t seeds = 1;                  ///< repetition k has the scenario's seed + k
  double jitter = 0.0;                      ///< length of a random shift of the start [m]
};

/// A comparison that was checked before its first run. Runs are numbered by scene first, then by algorithm, then by
/// seed. A scene has cases of its own, because its seeds and starts are.
struct Comparison {
  std::vector<Cases> scenes;
  std::vector<std::string> names;  ///< unique names of the scenes' files, without extension
  std::vector<std::string> algorithms;
  std::size_t seeds = 1;
  std::vector<std::string> warnings = {};  ///< without duplicates

  /// Runs of a scene.
  std::size_t each() const { return algorithms.size() * seeds; }
  std::size_t size() const { return scenes.size() * each(); }
  std::size_t scene(std::size_t run) const { return run / each(); }
  const std::string& algorithm(std::size_t run) const { return algorithms[run % each() / seeds]; }
  /// The scenario of a run. Thread-safe.
  LoadedScenario load(std::size_t run) const { return scenes[scene(run)].load(run % each()); }
  /// The folder of a scene's tables in that of the comparison: SCENARIO if there are several scenes, else empty.
  std::filesystem::path scene_folder(std::size_t scene) const { return scenes.size() > 1 ? names[scene] : ""; }
  /// The folder of a run's files in that of the comparison: [SCENARIO/]ALGORITHM[/seed_K], the parts in brackets where
  /// there are several.
  std::filesystem::path folder(std::size_t run) const;
};

/// Loads every scene with every algorithm and reads the files they name. Throws InputError for the first that is wrong,
/// for two scenes of one name, and where jitter cannot shift the start because the motion prescribes it.
Comparison planned(const ComparisonQuestion& question);

/// Removes what an earlier comparison of these scenes left in a folder: its tables, and the files of runs of any law
/// and seed. Other files stay.
void remove_earlier_comparison(const std::filesystem::path& folder, const Comparison& comparison);

}  // namespace hapbench
