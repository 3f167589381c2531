#pragma once

namespace hapbench {

/// What a handle may vibrate unless it is said otherwise [m/s rms above 30 Hz]. It is a speed because vibrations of the
/// hand from 16 to 400 Hz of equal speed are about equally unpleasant (Griffin, Industrial Health 50, 2012). Its value
/// is our choice, as of the classes of motion; a hand that holds a cylinder feels less than a hundredth of it at 150 to
/// 200 Hz (Brisben, Hsiao and Johnson, Journal of Neurophysiology 81, 1999).
inline constexpr double kMostVibration = 1e-3;

}  // namespace hapbench
