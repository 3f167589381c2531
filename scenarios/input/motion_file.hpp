#pragma once

#include <filesystem>
#include <string_view>

#include "sim/tool/motion.hpp"

namespace hapbench {

/// The recorded stroke in the contents of a file: CSV with header time_s,px_m,py_m,pz_m and then axis_x,axis_y,axis_z
/// or qw,qx,qy,qz, times strictly increasing, axes not zero, quaternions of norm 1 within 0.001 (both are normalised).
/// A quaternion turns the tool's frame, whose axis points along -z, into the world's. Throws InputError.
RecordedMotion motion_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
