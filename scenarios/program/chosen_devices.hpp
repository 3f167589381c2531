#pragma once

#include <string>
#include <vector>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/stability/field_limit.hpp"

namespace hapbench {

/// Returns the devices that the entries of `given` select, in the order of the entries. An entry is one of:
/// - "ideal", "admittance" or the name of a preset (compared_devices()): this device;
/// - the name of a preset followed by [soft] or [stiff]: the preset at this end of the range of its unpublished
///   parameters;
/// - "impedance": all presets;
/// - "all": "ideal", "admittance" and all presets;
/// - a path, such as NAME.json: the device in this JSON file (device_of_file()).
/// Throws InputError for an unknown entry, an invalid file, or two devices with the same name.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given);

}  // namespace hapbench
