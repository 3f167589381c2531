#pragma once

#include <optional>

/// Margins of a choice.
namespace hapbench {

/// The margins of a choice until the worst run of the families is not settled any more, at most kMostGain and
/// kMostDelay; empty where a margin has no meaning, such as the delay of an ideal device.
struct TuneMargins {
  std::optional<double> gain;           ///< factor on K
  std::optional<double> delay_samples;  ///< more delay of the device's force, or of an admittance device's servo
  std::optional<double> damping_ratio;  ///< of the least damped mode of the loop in contact
};
inline constexpr double kMostGain = 64.0, kMostDelay = 64.0;

class Trials;
struct TuneTrial;

/// Finds the margins of a verified choice by runs of all members of the families, and by the eigenvalues of the loop in
/// contact.
TuneMargins margins_of(Trials& trials, const TuneTrial& choice);

}  // namespace hapbench
