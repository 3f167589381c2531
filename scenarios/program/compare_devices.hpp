#pragma once

#include <string>
#include <vector>

#include "scenarios/program/command.hpp"

namespace hapbench {

/// The question of `compare --devices`.
struct CompareDevicesOptions {
  std::vector<std::string> devices;     ///< names, "all", and files NAME.json
  std::vector<std::string> scenarios;   ///< empty: default_device_scenes
  std::vector<std::string> algorithms;  ///< empty: shaped_stiffness and summation
  std::vector<std::string> overrides;
  std::string vibration;              ///< largest allowed [m/s rms]; empty: kMostVibration
  std::vector<std::string> friction;  ///< factors of the devices' dry friction, besides 1; "none": no interval of K
  std::string resolution;             ///< relative width of a limit; empty: the default of DeviceQuestion
  unsigned jobs = 0;                  ///< 0: as many as the machine has threads
  std::string out;
  OutputOptions output;
};

/// The names that --devices takes besides files: "all", "impedance", and every device of the program.
std::vector<std::string> device_names();

/// The bundled scenes of a hand that taps on a flat wall, in a corner and in a hole.
std::vector<std::string> default_device_scenes();

/// A line for whoever finds different stiffnesses by `limit`, by the maps and by `compare --devices`.
inline constexpr const char* kWhichStiffness =
    "why K differs between compare --devices, limit and stability --map: device_model/README.md, \"Which K to quote?\"\n";

/// Finds the largest stable stiffness on each device, prints and writes the tables. Returns the exit status.
int compare_devices(const CompareDevicesOptions& options);

}  // namespace hapbench
