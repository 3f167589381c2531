#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/axis.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// The inputs of `tune`, and the ranges that it searches.
namespace hapbench {

/// Largest number of runs of a search. The search for one law is repeated with other limits if nothing is feasible.
/// Margins, error estimates and verification need a few hundred runs more.
inline constexpr std::size_t kMaxTuneRuns = 6000;
/// Number of stiffnesses below the K of a choice at which the run of the scene must have low vibration, too, unless
/// TuneQuestion::allow_vibration is true.
inline constexpr std::size_t kLowVibrationSamples = 4;
inline constexpr double kLowVibrationFrom = 0.9;  ///< these stiffnesses are above this share of K

/// Inputs of tuned_law().
struct TuneQuestion {
  ScenarioText scenario;
  std::vector<std::string> overrides;
  double margin = 2.0;                             ///< gain margin G: runs must be settled up to G K
  std::map<std::string, MetricBound> limits = {};  ///< limits on metrics, for all variants at K
  /// False: the run of the scene itself must have low vibration by the rules of the diagnosis.
  bool allow_vibration = false;
  std::vector<std::string> families = {"hands"};  ///< variant sets, from kFamilies
  /// Searched range of the damping ratio zeta. On every device, zeta refers to the mass rendering.mass_kg.
  Range damping_ratio = {0.01, 10.0, true};
  /// Searched range of the virtual mass of an admittance device [kg]; empty: half to twice the scene's virtual mass.
  std::optional<Range> mass = {};
  bool filters = false;  ///< true: velocity filters of impedance devices are searched too
  unsigned threads = 1;  ///< number of parallel runs; does not change the result
  /// Called repeatedly with the number of runs so far and the purpose of the current runs, such as "search".
  std::function<void(std::size_t runs, const std::string& purpose)> on_runs = {};
};

/// The ranges that are searched.
struct TuneRanges {
  Range stiffness;                     ///< K [N/m]
  std::optional<Range> damping_ratio;  ///< zeta; empty if it has no effect
  std::optional<Range> mass;           ///< virtual mass [kg]; empty if it has no effect
};
/// Returns the ranges that a search uses for one law in the question's scene.
TuneRanges tune_ranges(const TuneQuestion& question, const std::string& algorithm);

}  // namespace hapbench
