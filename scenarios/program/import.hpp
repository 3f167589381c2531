#pragma once

#include <string>
#include <vector>

/// Words that options of `hapbench import` take, for completion.
namespace hapbench {

/// Values of --format and --orientation, which the Python package hapbench_import reads.
inline const std::vector<std::string> kRecordingFormats = {"csv", "traj", "hapi", "hapi-binary"};
inline const std::vector<std::string> kRecordedOrientations = {"none",      "axis",       "quat_wxyz",
                                                               "quat_xyzw", "axis_angle", "matrix"};

/// Names of the presets that come with the program, in order. Throws InputError when their folder is missing.
std::vector<std::string> import_preset_names();

}  // namespace hapbench
