#pragma once

#include <string>
#include <vector>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/stability/field_limit.hpp"

namespace hapbench {

/// The devices of these names and files, each once; a preset's name with [soft] or [stiff] behind it is the preset at
/// that end of what nobody published of it. Throws InputError.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given);

}  // namespace hapbench
