#pragma once

#include <filesystem>
#include <string_view>

#include "sim/tool/motion.hpp"

namespace hapbench {

/// The recorded stroke in the contents of a file: CSV with header time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z, times
/// strictly increasing, axes not zero (they are normalised). Throws InputError.
RecordedMotion motion_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
