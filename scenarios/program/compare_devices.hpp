#pragma once

#include <string>
#include <vector>

#include "scenarios/program/command.hpp"

namespace hapbench {

/// What `compare --devices` is asked.
struct CompareDevicesOptions {
  std::vector<std::string> devices;     ///< names, or all, and files NAME.json
  std::vector<std::string> scenarios;   ///< none: those of a hand that taps on a wall, in a corner and in a hole
  std::vector<std::string> algorithms;  ///< none: shaped_stiffness and summation
  std::vector<std::string> overrides;
  std::string vibration;   ///< most of it [m/s rms]
  std::string resolution;  ///< of a limit, relative
  unsigned jobs = 0;       ///< 0: as many as the machine has threads
  std::string out;
  OutputOptions output;
};

/// Most vibration of the handle where none is given [m/s rms above 30 Hz]. Of hand-transmitted vibration from 16 to
/// 400 Hz equal speeds are about equally unpleasant (Griffin, "Frequency-dependence of psychophysical and physiological
/// responses to hand-transmitted vibration", Industrial Health 50, 2012), so that it is a speed; its value is ours,
/// that of the classes of motion (classify.hpp). A cylinder in the hand lets one feel less than a hundredth of it at
/// 150 to 200 Hz (Brisben, Hsiao and Johnson, Journal of Neurophysiology 81, 1999).
inline constexpr double kMostVibration = 1e-3;

/// The number given to --vibration [m/s]. Throws InputError.
double vibration_of(const std::string& text);
/// The number given to --resolution. Throws InputError.
double resolution_of(const std::string& text);

/// Finds the largest stable stiffness on each device, prints and writes the table. Returns the exit status.
int compare_devices(const CompareDevicesOptions& options);

}  // namespace hapbench
