#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/description/load_scenario.hpp"

namespace hapbench {

/// A row of trajectory.csv.
struct ReadRow {
  double time = 0.0;
  Vec3 tip, force, measured, driving, handle;  ///< p, f, fmeas, fin, h [m, N]
  bool touches = false;
};

/// The files of a run, as far as rules read them.
struct RunFiles {
  LoadedScenario loaded;  ///< of scenario.effective.json
  std::string outcome;    ///< of summary.json
  std::string ending;     ///< what left its bounds, or the warning about a run that missed; empty for others
  std::map<std::string, double, std::less<>> metrics;  ///< those that have a value, as `expect` names them
  std::vector<ReadRow> rows;                           ///< empty where no trajectory was recorded
  std::optional<double> step_time;                     ///< that 99 % of the steps take at most, by timing.json [s]

  std::optional<double> metric(std::string_view name) const;
  const Scenario& scenario() const { return loaded.scenario; }
};

/// Throws InputError, with the file, where a folder is no run's or a file is none that hapbench wrote.
RunFiles read_run(const std::filesystem::path& folder);

}  // namespace hapbench
