#pragma once

#include <optional>

/// Robustness margins of a tuned setting.
namespace hapbench {

/// Margins up to which all variants of a choice stay settled. Limited to kMaxGainMargin and kMaxDelayMargin. A margin
/// is empty if it has no meaning, such as the delay of an ideal device.
struct TuneMargins {
  std::optional<double> gain;           ///< largest factor on K
  std::optional<double> delay_samples;  ///< largest additional delay of the device's force or servo [samples]
  std::optional<double> damping_ratio;  ///< damping ratio of the least damped mode of the loop in contact
};
/// Largest margins that are searched: factor on K, and delay [samples].
inline constexpr double kMaxGainMargin = 64.0, kMaxDelayMargin = 64.0;

class Trials;
struct TuneTrial;

/// Computes the margins of a verified choice: gain and delay by runs of all variants, damping ratio by the eigenvalues
/// of the loop in contact.
TuneMargins margins_of(Trials& trials, const TuneTrial& choice);

}  // namespace hapbench
