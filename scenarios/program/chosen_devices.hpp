#pragma once

#include <string>
#include <vector>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/stability/field_limit.hpp"

namespace hapbench {

/// Returns the devices that names and files select, in the order given. Each name is a device, "all",
/// "impedance" (all presets), or a file NAME.json. A preset's name followed by [soft] or [stiff] selects the
/// preset at that end of the range of its unpublished parameters. Throws InputError for an unknown name, an
/// invalid file, or two devices with one name.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given);

}  // namespace hapbench
