#pragma once

#include <optional>

/// Robustness margins of the choice, that is, of the setting and stiffness that the search selected.
namespace hapbench {

/// Robustness margins of a choice. All scene variants are settled up to the gain margin and up to the delay margin.
/// These margins are searched up to kMaxGainMargin and kMaxDelayMargin. A margin is empty if it does not apply, such as
/// the delay of an ideal device. The gain margin is also empty if the range of K ends at G K, where G is the required
/// gain margin.
struct TuneMargins {
  std::optional<double> gain;           ///< largest factor on the stiffness K
  std::optional<double> delay_samples;  ///< largest additional delay of the device's force or servo [samples]
  std::optional<double> damping_ratio;  ///< damping ratio of the least damped mode of the loop in contact
};
/// Upper ends of the searches: factor on K, and delay [samples].
inline constexpr double kMaxGainMargin = 64.0, kMaxDelayMargin = 64.0;

class Trials;
struct TuneTrial;

/// Computes the margins of a verified choice: gain and delay by runs of all variants, damping ratio by the eigenvalues
/// of the loop in contact.
TuneMargins margins_of(Trials& trials, const TuneTrial& choice);

}  // namespace hapbench
