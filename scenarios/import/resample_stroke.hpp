#pragma once

#include <optional>

#include "scenarios/import/stroke_samples.hpp"

namespace hapbench {

/// The clock of a recording.
struct StrokeClock {
  double first = 0.0;                                                    ///< time of the first sample [s]
  double duration = 0.0;                                                 ///< from the first to the last sample [s]
  double interval_min = 0.0, interval_median = 0.0, interval_max = 0.0;  ///< between samples [s]
  bool is_regular = false;  ///< every sample within a thousandth of an interval of where an even clock would have it
};

/// Precondition: two samples at least.
StrokeClock clock_of(const StrokeSamples& stroke);

/// An interval much longer than usual, over which a stroke is bridged.
struct StrokeGap {
  std::size_t before = 0;  ///< index of the last sample before it
  double duration = 0.0;   ///< [s]
};

/// Intervals are gaps from ten median ones on.
std::vector<StrokeGap> gaps_in(const StrokeSamples& stroke, const StrokeClock& clock);

/// The stroke at an even rate [Hz] from its first sample on, time counted from there: positions and forces between
/// samples linearly, orientations along the arc between them (slerp). Throws InputError for more than ten million
/// samples.
StrokeSamples resampled(const StrokeSamples& stroke, double rate);

}  // namespace hapbench
