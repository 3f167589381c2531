#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// The lines of C that open a tuned scenario in a haptic loop (device_model/live/hapbench_renderer.h).
namespace hapbench {

/// Returns overrides for a renderer whose device is mounted with `scale`, virtual metres per metre of the device. With
/// these overrides, the hand feels the coefficients of `scenario`. The mount does not scale forces. Therefore the
/// overrides divide the virtual mass and the coefficients of "rendering" per length or speed (N/m, N s/m, s/m) by the
/// scale. Returns no overrides if the scale is 1.
std::vector<std::string> overrides_for_scale(const Json& scenario, double scale);

/// Returns the lines of C that open the scenario in `file` with the overrides of overrides_for_scale(). `scenario`: the
/// content of the file.
std::string loop_lines(const Json& scenario, const std::filesystem::path& file, double scale);

}  // namespace hapbench
