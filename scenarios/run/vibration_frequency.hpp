#pragma once

#include <optional>
#include <span>

#include "sim/core/types.hpp"

namespace hapbench {

/// Returns the frequency [Hz] of the strongest lasting oscillation of a force [N] that is sampled every `dt` seconds:
/// the largest peak, above 10 Hz, in the spectrum of the force minus its mean, with a Hann window. `hapbench audit`
/// uses the same spectrum and the same conditions. Empty in four cases: there are fewer than 64 samples or six periods;
/// the peak is at most 4 times the median amplitude of its neighbourhood, as in noise; or the amplitude in the middle
/// third of the samples is less than half of the amplitude in all samples, as after a single jump. Cost: a few ms.
std::optional<double> oscillation_frequency(std::span<const Vec3> force, double dt);

}  // namespace hapbench
