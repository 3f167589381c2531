#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/analysis/tuning/tune.hpp"

/// The results of `tune`. The choice of a law is its best feasible setting (TunedLaw::choice). A setting includes the
/// stiffness K.
namespace hapbench {

/// The question of a `tune` command, and the answer for each law.
struct Tuning {
  TuneQuestion question;
  std::string scene;  ///< name of the scene, followed by the name of the device
  TuneRanges ranges;  ///< search ranges of the first law
  std::vector<TunedLaw> laws;
  std::vector<const TunedLaw*> ranking;  ///< laws with a feasible choice, best first
  std::size_t runs = 0;                  ///< number of simulations over all laws
};

/// Returns the laws with a feasible choice, best first. The best law has the smallest settled depth (metric
/// inside_settled_m). In scenes without this metric, the best law has the largest rendered stiffness K lambda_max.
std::vector<const TunedLaw*> ranking_of(const std::vector<TunedLaw>& laws);

/// A stability margin of a choice: its column in tune.csv, its heading, its JSON key, and its printed text. If the
/// margin is at least `max`, it lies at the end of the range in which it is searched, and the text says "more than".
struct Margin {
  const char *column, *unit, *meaning, *heading, *key, *text;
  std::optional<double> TuneMargins::*of;
  double max;
};
inline constexpr Margin kMargins[] = {
    {"gain_margin", "1", "largest factor on K, up to 64, with which all runs settle and the contact loop is stable",
     "gain", "gain", "gain margin {}", &TuneMargins::gain, 0.99 * kMaxGainMargin},
    {"delay_margin_samples", "time steps",
     "largest additional delay of the device, up to 64 time steps, with which all runs settle and the contact loop is "
     "stable; empty without a device",
     "delay", "delay_samples", "delay margin {} samples", &TuneMargins::delay_samples, kMaxDelayMargin},
    {"damping_margin", "1", "damping ratio of the least damped mode of the contact loop; empty without a contact loop",
     "", "damping_ratio", "damping ratio {} of the least damped mode", &TuneMargins::damping_ratio, 2.0}};

/// Returns the chosen stiffness K, with the digits that are significant at the resolution of the search.
std::string stiffness_text(const TuneTrial& choice);

}  // namespace hapbench
