#pragma once

#include <span>

#include "scenarios/cases/cases.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Scenes, each under the same laws and with the same number of seeds.
namespace hapbench {

/// The scenario's seed and those after it. Unless `jitter` [m] is 0, a shift of the start by that length goes along
/// with each, whose direction depends only on the seed, so that all algorithms start from the same places: uniform on
/// the sphere, in planar scenes on the circle z = 0.
Axis seed_axis(const Scenario& scenario, std::size_t seeds, double jitter);

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
  /// Returns the folder of a scene's tables, relative to that of the comparison: SCENARIO if there are several scenes,
  /// else empty.
  std::filesystem::path scene_folder(std::size_t scene) const { return scenes.size() > 1 ? names[scene] : ""; }
  /// Returns the folder of a run's files, relative to that of the comparison: [SCENARIO/]ALGORITHM[/seed_K], the parts
  /// in brackets where there are several.
  std::filesystem::path folder(std::size_t run) const;
};

/// Loads every scene with every algorithm and reads the files they name. Throws InputError for the first that is wrong,
/// for two scenes of one name, and where jitter cannot shift the start because the motion prescribes it.
Comparison planned(const ComparisonQuestion& question);

/// Runs all cases of a list, numbered one after the other, and writes the files of each into the folder that `folder`
/// names, or none without it. Runs in one environment share its shell, which is built once. Neither reports nor files
/// depend on the number of jobs. Reports have no targets: there may be very many, and files have them. Throws IoError
/// when something cannot be written, and Stopped after SIGINT or SIGTERM.
std::vector<Result> run_all(std::span<const Cases> cases, const JobOptions& jobs,
                            const std::function<std::filesystem::path(std::size_t run)>& folder = {});

/// Removes what an earlier comparison of these scenes left in a folder: its tables, and the files of runs of any law
/// and seed, so that laws are not shown beside those of another question. Other files stay.
void remove_earlier_comparison(const std::filesystem::path& folder, const Comparison& comparison);

}  // namespace hapbench
