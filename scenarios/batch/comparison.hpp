#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/batch/cases.hpp"
#include "scenarios/run/outcome.hpp"

/// Comparisons: several scenes, each run with the same force laws and the same number of seeds.
namespace hapbench {

/// Arguments of the command `compare`.
struct ComparisonQuestion {
  std::vector<std::filesystem::path> scenarios;  ///< scenario files
  std::vector<std::string> algorithms;
  std::vector<std::string> overrides = {};  ///< overrides for all runs, as in --set
  std::uint64_t seeds = 1;                  ///< number of repetitions; repetition k has the scenario's seed + k
  double jitter = 0.0;                      ///< length of a random displacement of the starting position [m]
  RunLength length = RunLength::until_failure;
};

/// A comparison whose scenarios were checked before the first run. Runs are numbered by scene, then by
/// algorithm, then by seed. Each scene has its own Cases, because its seeds and starting positions depend on
/// its scenario.
struct Comparison {
  std::vector<Cases> scenes;
  std::vector<std::string> names;  ///< unique names of the scenes: their files without extension
  std::vector<std::string> algorithms;
  std::size_t seeds = 1;
  std::vector<std::string> warnings = {};  ///< warnings about the scenes, without duplicates
  RunLength length = RunLength::until_failure;

  /// Number of runs of each scene.
  std::size_t each() const { return algorithms.size() * seeds; }
  std::size_t size() const { return scenes.size() * each(); }
  std::size_t scene(std::size_t run) const { return run / each(); }
  const std::string& algorithm(std::size_t run) const { return algorithms[run % each() / seeds]; }
  /// Loads the scenario of a run. Thread-safe.
  LoadedScenario load(std::size_t run) const { return scenes[scene(run)].load(run % each()); }
  /// Returns the folder of a scene's tables, relative to the folder of the comparison: SCENARIO if there are
  /// several scenes, else empty.
  std::filesystem::path scene_folder(std::size_t scene) const { return scenes.size() > 1 ? names[scene] : ""; }
  /// Returns the folder of a run's files, relative to the folder of the comparison:
  /// [SCENARIO/]ALGORITHM[/seed_K]. Parts in brackets exist only if there are several scenes or seeds.
  std::filesystem::path folder(std::size_t run) const;
  /// Returns the folders of the scenes' tables in the folder `out` of a comparison.
  std::vector<std::filesystem::path> scene_folders(const std::filesystem::path& out) const;
  /// Returns the folders in `out` that this comparison, or an earlier comparison of these scenes, may use for its runs:
  /// a folder for each algorithm of the program, and its existing subfolders of seeds. Subfolders come before the
  /// folder that contains them.
  std::vector<std::filesystem::path> run_folders(const std::filesystem::path& out) const;
};

/// Loads every scene with every algorithm and reads the files that the scenes name. Throws the InputError of the first
/// scene with an error. Also throws InputError if two scenes have the same name, if there are more than kMaxRuns runs,
/// or if `jitter` is given although a scene prescribes the position.
Comparison planned(const ComparisonQuestion& question);

/// Removes the files of an earlier comparison of these scenes from a folder: its tables, and the files of runs
/// with any force law and seed. Other files stay.
void remove_earlier_comparison(const std::filesystem::path& folder, const Comparison& comparison);

}  // namespace hapbench
