#pragma once

namespace hapbench {

/// Default limit for the vibration of a handle [m/s rms above 30 Hz]. It limits a speed, because hand vibrations of
/// equal speed between 16 and 400 Hz are about equally unpleasant (Griffin, Industrial Health 50, 2012). The value was
/// chosen for hapbench, like the limits of the motion classes. At 150 to 200 Hz, a hand that holds a cylinder detects
/// less than a hundredth of this value (Brisben, Hsiao and Johnson, Journal of Neurophysiology 81, 1999).
inline constexpr double kMaxVibration = 1e-3;

}  // namespace hapbench
