#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// The lines of C that open a tuned scenario in a haptic loop (device_model/live/hapbench_renderer.h).
namespace hapbench {

/// Returns the overrides with which a hand feels the coefficients of `scenario` through a device that is mounted with
/// `scale`, virtual metres per metre of the device. Forces are not scaled. Therefore the coefficients of "rendering"
/// per length or speed (N/m, N s/m, s/m) and the virtual mass are divided by the scale. Empty if the scale is 1.
std::vector<std::string> overrides_for_scale(const Json& scenario, double scale);

/// Returns the lines that open the scenario in `file`. `scenario`: the content of the file.
std::string loop_lines(const Json& scenario, const std::filesystem::path& file, double scale);

}  // namespace hapbench
