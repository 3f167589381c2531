#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/tuning/tune.hpp"

/// The answer of `tune`.
namespace hapbench {

/// A question and its answer, by law.
struct Tuning {
  TuneQuestion question;
  std::string scene;  ///< name of the scene, with that of the device
  TuneRanges ranges;  ///< of the first law
  std::vector<TunedLaw> laws;
  std::vector<const TunedLaw*> ranking;  ///< those with a choice, best first
  std::size_t runs = 0;                  ///< simulations in all
};

/// Best is the least settled depth, where the scene has none the largest K lambda_max.
std::vector<const TunedLaw*> ranking_of(const std::vector<TunedLaw>& laws);

/// A margin of a choice: its column, its name in JSON and in words, and the largest that is searched.
struct Margin {
  const char *column, *unit, *meaning, *heading, *key, *words;
  std::optional<double> TuneMargins::*of;
  double most;
};
inline constexpr Margin kMargins[] = {
    {"gain_margin", "1", "largest factor on K, up to 64, with which all runs settle and the contact loop is stable",
     "gain", "gain", "gain margin {}", &TuneMargins::gain, 0.99 * kMostGain},
    {"delay_margin_samples", "time steps",
     "largest additional delay of the device, up to 64 time steps, with which all runs settle and the contact loop is "
     "stable; empty without a device",
     "delay", "delay_samples", "delay margin {} samples", &TuneMargins::delay_samples, kMostDelay},
    {"damping_margin", "1", "damping ratio of the least damped mode of the contact loop; empty without a contact loop",
     "", "damping_ratio", "damping ratio {} of the least damped mode", &TuneMargins::damping_ratio, 2.0}};

/// With the digits that the search leaves it.
std::string stiffness_text(const TuneTrial& choice);

}  // namespace hapbench
