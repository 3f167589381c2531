#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/description/load_scenario.hpp"

/// Rules that say what is wrong with a run and what to try, each from a number and a stated threshold.
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

/// A rule: something is wrong where its number is larger than the threshold.
struct ExplainRule {
  const char* name;
  const char* number;  ///< what it is
  const char* unit;    ///< "1" for pure numbers
  double threshold;
  const char* says;     ///< what is wrong, {} for the number
  const char* attempt;  ///< what to try
  /// The number; none where the rule does not apply or the run did not record what it needs.
  std::optional<double> (*value)(const RunFiles& run);
  std::string (*more)(const RunFiles& run) = nullptr;  ///< further facts, behind what is wrong
};

/// In the order in which they are told: how the run ended, then why.
std::span<const ExplainRule> explain_rules();

struct Explanation {
  const ExplainRule* rule;
  double value;
  std::string says;
};

/// The rules that apply to the run, in their order; empty where nothing is wrong.
std::vector<Explanation> explained(const RunFiles& run);

}  // namespace hapbench
