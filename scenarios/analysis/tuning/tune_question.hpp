#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/axis.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// The question of `tune`, and the ranges that it searches.
namespace hapbench {

/// The search for a law ends at this number of simulations; margins, errors and verification take a few hundred more.
inline constexpr std::size_t kMostTuneRuns = 6000;

struct TuneQuestion {
  ScenarioText scenario;
  std::vector<std::string> overrides;
  double margin = 2.0;  ///< G: settled up to G K
  /// Limits on metrics of every run at K; without any, the own run must have low vibration by the rules of the
  /// diagnosis.
  std::map<std::string, MetricBound> limits = {};
  std::vector<std::string> families = {"hands"};  ///< all their runs have to hold (family.hpp)
  Range damping_ratio = {0.01, 10.0, true};       ///< zeta; of an impedance device by the mass of its handle
  std::optional<Range> mass = {};  ///< virtual mass on an admittance device [kg]; none: half to twice the scene's
  bool filters = false;            ///< also try velocity filters of an impedance device
  unsigned threads = 1;
  std::function<void(std::size_t runs)> on_runs = {};  ///< called now and then with the number of runs so far
};

/// The ranges that are searched; zeta and the virtual mass have none where they have no effect.
struct TuneRanges {
  Range stiffness;
  std::optional<Range> damping_ratio, mass;
};
TuneRanges tune_ranges(const TuneQuestion& question, const std::string& algorithm);

}  // namespace hapbench
