#pragma once

#include "scenarios/import/stroke_samples.hpp"

namespace hapbench {

/// What smoothing changed.
struct SmoothingChange {
  double position_largest = 0.0, position_rms = 0.0;  ///< [m]
  double angle_largest = 0.0, angle_rms = 0.0;        ///< [rad]
};

/// Fits a polynomial to every window of neighbours by least squares and takes its value in the middle (Savitzky and
/// Golay 1964); at both ends, the values of the first and the last window's polynomial. Positions and the components of
/// quaternions, which are normalised again, are smoothed; forces are a measurement and stay. Times must be regular.
/// Throws InputError unless window is odd, order >= 0 below it, and no more than the stroke's samples.
SmoothingChange smooth(StrokeSamples& stroke, const Smoothing& smoothing);

}  // namespace hapbench
